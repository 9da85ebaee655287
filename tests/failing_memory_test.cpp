// A solver that finds no memory: the query throws, and Embree goes on as before.
#include <cstdlib>
#include <new>
#include <thread>

#include <gtest/gtest.h>

#include "renderer/trace/cell_scene.h"
#include "tests/support/random_scene.h"

namespace {
thread_local bool t_is_out_of_memory = false;
} // namespace

void* operator new(size_t size) {
  void* const memory = t_is_out_of_memory ? nullptr : std::malloc(size);
  if (!memory) throw std::bad_alloc();
  return memory;
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, size_t) noexcept { std::free(memory); }

namespace kelpie {
namespace {

/// A thread's first query allocates what its solvers work with. Asks without memory, and then with it.
template <class Ask>
void expect_throws_once(const CellScene& scene, const Ask& ask) {
  std::thread([&] {
    flush_denormals_in_this_thread();
    bool has_thrown = false;
    t_is_out_of_memory = true;
    try {
      ask(scene);
    } catch (const std::bad_alloc&) {
      has_thrown = true;
    }
    t_is_out_of_memory = false;
    EXPECT_TRUE(has_thrown);
    EXPECT_TRUE(ask(scene));
  }).join();
}

void expect_throws_once(const SampledField& field) {
  std::vector<Slabs> shapes(1);
  shapes[0].push_back(std::make_shared<const ShapeCells>(build_cells(compile(field, 0.5))));
  const CellScene scene(std::move(shapes));
  std::array<Ray, k_packet> rays;
  for (size_t i = 0; i < rays.size(); ++i) rays[i].origin = {0.001f * float(i), 0.001f, -5}, rays[i].direction = {0, 0, 1};
  SolveCounters counters;
  std::array<CellHit, k_packet> hits;
  expect_throws_once(scene, [&](const CellScene& s) { return s.intersect(rays[0], counters, hits[0]); });
  expect_throws_once(scene, [&](const CellScene& s) { return s.occluded(rays[0], counters); });
  expect_throws_once(scene, [&](const CellScene& s) { return s.intersect(rays, counters, hits.data()) == 0xffff; });
  expect_throws_once(scene, [&](const CellScene& s) { return s.occluded(rays, counters) == 0xffff; });
}

TEST(FailingMemory, ThrowsFromBlobs) {
  SampledField field;
  add(field, Point<SampledMode>{});
  expect_throws_once(field);
}

TEST(FailingMemory, ThrowsFromTrees) {
  SampledField field;
  Segment<SampledMode> segment;
  segment.from = {-1, 0, 0}, segment.to = {1, 0, 0};
  add(field, segment);
  expect_throws_once(field);
}

} // namespace
} // namespace kelpie
