// Words that other programs and papers use for what scene files call otherwise.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace kelpie {

/// ` (did you mean "sdf_sphere" or "point"?)` for a word that means these elsewhere, or that is a slip of one of them; empty where nothing
/// is near. Of other words only those count that stand for a name in `known`.
std::string near_names(std::string_view typed, std::span<const std::string_view> known);

/// The same words, for tests.
struct OtherName {
  std::string_view word, name, other_name{}; ///< `other_name` may be empty
};
std::span<const OtherName> other_names();

} // namespace kelpie
