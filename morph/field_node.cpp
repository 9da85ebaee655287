#include "morph/field_node.h"

#include <algorithm>

#include "base/one_of.h"

namespace kelpie {

template struct OneOf<FieldKinds, AnimatedMode>;
template struct OneOf<FieldKinds, SampledMode>;

bool is_equal(const SampledField& a, const SampledField& b) {
  const auto end = [](const SampledField& field) { return field.nodes.end() - std::ptrdiff_t(field.piece_count); };
  return a.materials == b.materials && std::equal(a.nodes.begin(), end(a), b.nodes.begin(), end(b), [](const auto& x, const auto& y) {
           return x.index() == y.index() && std::visit([&]<class Kind>(const Kind& kind) { return is_equal(kind, std::get<Kind>(y)); }, x);
         });
}

} // namespace kelpie
