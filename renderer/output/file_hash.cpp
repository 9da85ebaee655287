#include "renderer/output/file_hash.h"

#include <algorithm>
#include <memory>
#include <new>

#include <fmt/format.h>
#include <xxhash.h>

#include "base/error.h"

namespace kelpie {

namespace {

using Bytes = std::span<const unsigned char>;

constexpr size_t k_digits = 32;

/// Where the digits are; the file's size where they are not. An attribute is its name, its type and its size, and then its value.
size_t place_of_digits(Bytes file) {
  const std::string before = std::string(k_file_hash_attribute) + '\0' + "string" + '\0' + static_cast<char>(k_digits) + '\0' + '\0' + '\0';
  const auto found = std::search(file.begin(), file.end(), before.begin(), before.end(),
                                 [](unsigned char a, char b) { return a == static_cast<unsigned char>(b); });
  const size_t place = static_cast<size_t>(found - file.begin()) + before.size();
  return place + k_digits <= file.size() ? place : file.size();
}

std::string hash_of(Bytes before, Bytes after) {
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(), XXH3_freeState);
  if (!state) throw std::bad_alloc();
  const std::string digits = unsealed_file_hash();
  XXH3_128bits_reset(state.get());
  XXH3_128bits_update(state.get(), before.data(), before.size());
  XXH3_128bits_update(state.get(), digits.data(), digits.size());
  XXH3_128bits_update(state.get(), after.data(), after.size());
  const XXH128_hash_t hash = XXH3_128bits_digest(state.get());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

} // namespace

std::string unsealed_file_hash() { return std::string(k_digits, '0'); }

void seal(std::span<unsigned char> file) {
  const size_t place = place_of_digits(file);
  if (place == file.size()) throw Error(ExitStatus::internal, "the EXR encoder left the file's hash out");
  const std::string hash = hash_of(file.first(place), file.subspan(place + k_digits));
  std::copy(hash.begin(), hash.end(), file.begin() + static_cast<std::ptrdiff_t>(place));
}

bool is_sealed(Bytes file) {
  const size_t place = place_of_digits(file);
  if (place == file.size()) return false;
  const std::string hash = hash_of(file.first(place), file.subspan(place + k_digits));
  return std::equal(hash.begin(), hash.end(), file.begin() + static_cast<std::ptrdiff_t>(place));
}

} // namespace kelpie
