// The members of OneOf. Included where a list of kinds is complete, by the one file that instantiates them: `template struct OneOf<List,
// Mode>;`
#pragma once

#include "base/kind.h"

namespace kelpie {

template <template <class> class... Kinds, class Mode>
OneOf<KindList<Kinds...>, Mode>::OneOf() = default;
template <template <class> class... Kinds, class Mode>
OneOf<KindList<Kinds...>, Mode>::OneOf(const OneOf&) = default;
template <template <class> class... Kinds, class Mode>
OneOf<KindList<Kinds...>, Mode>::OneOf(OneOf&&) noexcept = default;
template <template <class> class... Kinds, class Mode>
OneOf<KindList<Kinds...>, Mode>& OneOf<KindList<Kinds...>, Mode>::operator=(const OneOf&) = default;
template <template <class> class... Kinds, class Mode>
OneOf<KindList<Kinds...>, Mode>& OneOf<KindList<Kinds...>, Mode>::operator=(OneOf&&) noexcept = default;
template <template <class> class... Kinds, class Mode>
OneOf<KindList<Kinds...>, Mode>::~OneOf() = default;

} // namespace kelpie
