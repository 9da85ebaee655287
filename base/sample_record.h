// A kind, or any other record, at one moment.
#pragma once

#include "base/table.h"

namespace kelpie {

namespace detail {
struct RecordSampler {
  double frame;
  const unsigned* node;          ///< what the next edge becomes
  const MaterialIndex* material; ///< what the next material becomes

  template <class From, class To>
  void value(const From& from, To& to) {
    if constexpr (IsAnimated<From>) {
      to = from.at(frame);
    } else if constexpr (IsEdge<From>) {
      to = *node++;
    } else if constexpr (IsMaterialEdge<From>) {
      to = *material++;
    } else if constexpr (std::is_same_v<To, SampledMode::File>) {
      // What was in it is an asset.
    } else if constexpr (std::is_same_v<From, To>) {
      to = from;
    } else if constexpr (IsOptional<From>) {
      if (from) value(*from, to.emplace());
    } else if constexpr (IsList<From>) {
      to.reserve(from.size());
      for (const auto& element : from) value(element, to.emplace_back());
    } else {
      static_assert(Record<From> && Record<To>, "say here what becomes of the new type");
      record(from, to);
    }
  }

  template <class From, class To>
  void record(const From& from, To& to) {
    rows(from, to, std::make_index_sequence<std::tuple_size_v<decltype(From::parameters())>>{});
  }
  /// No lambda: clang 14 may order what it captures otherwise in one source than in another, and all sources share the code.
  template <class From, class To, size_t... I>
  void rows([[maybe_unused]] const From& from, [[maybe_unused]] To& to, std::index_sequence<I...>) {
    (value(from.*(std::get<I>(k_table<From>).member), to.*(std::get<I>(k_table<To>).member)), ...);
  }
};
} // namespace detail

/// A record as it is at `frame`. `nodes` are what its edges become, in the order of for_each_edge, and `materials` what those become
/// that it names, in the order of for_each_value.
template <template <class> class Kind>
Kind<SampledMode> sample_record(const Kind<AnimatedMode>& animated, double frame, const unsigned* nodes = nullptr,
                                const MaterialIndex* materials = nullptr) {
  Kind<SampledMode> sampled;
  detail::RecordSampler{frame, nodes, materials}.record(animated, sampled);
  if constexpr (HasAssets<Kind<AnimatedMode>>) { // shared, not copied
    const auto share = [&]<size_t... I>(std::index_sequence<I...>) {
      ((sampled.*std::get<I>(Kind<SampledMode>::assets()) = animated.*std::get<I>(Kind<AnimatedMode>::assets())), ...);
    };
    share(std::make_index_sequence<std::tuple_size_v<decltype(Kind<AnimatedMode>::assets())>>{});
  }
  if constexpr (requires { sampled.prepare(); }) sampled.prepare();
  return sampled;
}

} // namespace kelpie
