#include "renderer/trace/surroundings.h"

#include "renderer/program/bound.h"

namespace kelpie {

Surroundings::Surroundings(const Tracer& tracer, const Box3& where) {
  const Box3d box{Vec3d(where.lower), Vec3d(where.upper)};
  for (const Slabs& slabs : tracer.cells().shapes()) {
    std::vector<Slab>& shape = shapes_.emplace_back();
    for (const std::shared_ptr<const ShapeCells>& s : slabs) {
      Slab& slab = shape.emplace_back(Slab{s.get(), {}, {}});
      const FieldProgram& program = s->program;
      if (program.code.steps.empty() || intersect(program.support, box).is_empty()) {
        slab.is_inside = false;
        continue;
      }
      std::vector<Interval> ranges;
      const Code code = bound(program, program.code, box, ranges);
      constexpr double k_margin = 1e-5; // bounds of blobs are found in float
      const Interval threshold = threshold_range(program);
      if (ranges.back().hi < threshold.lo * (1 - k_margin)) slab.is_inside = false;
      if (ranges.back().lo > threshold.hi * (1 + k_margin)) slab.is_inside = true;
      if (!slab.is_inside) slab.code = prune(program, code, ranges);
    }
  }
}

ShapeSet Surroundings::shapes_around(const Vec3& p, float time) const {
  ShapeSet around;
  for (size_t i = 0; i < shapes_.size(); ++i) {
    const size_t n = shapes_[i].size();
    const Slab& slab = shapes_[i][std::min(static_cast<size_t>(time * static_cast<float>(n)), n - 1)];
    bool is_inside = slab.is_inside.value_or(false);
    if (!slab.is_inside) {
      const FieldProgram& program = at(slab.cells->program, slab.code, slab.cells->slab_time(time));
      is_inside = evaluate(program, slab.code, Point3<double>{p.x, p.y, p.z}) > program.threshold;
    }
    if (is_inside) around.add(static_cast<uint32_t>(i));
  }
  return around;
}

} // namespace kelpie
