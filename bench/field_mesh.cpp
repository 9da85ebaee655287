#include "bench/field_mesh.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <openvdb/tools/VolumeToMesh.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "renderer/program/bound.h"

namespace kelpie {

namespace {

using Leaf = openvdb::FloatTree::LeafNodeType;
constexpr int k_block = Leaf::DIM;
/// Code is pruned in parallel down to boxes of this many blocks a side.
constexpr int k_parallel_blocks = 8;

class Sampler {
public:
  Sampler(const FieldProgram& program, double voxel) : program_(program), voxel_(voxel), trees_(background()) {}

  /// Samples the box of blocks [first, first + size), size a power of two, as far as the surface reaches.
  void sample(const openvdb::Coord& first, int size, const Code& parent) {
    // One voxel wider: if the sign is the same throughout, it is the same at the neighbours of the block's voxels
    // too, so that of two voxels with the surface between them both are in blocks that are sampled.
    const Vec3d origin = Vec3d(first.x(), first.y(), first.z()) * double(k_block);
    const Box3d box{(origin - 1.0) * voxel_, (origin + double(size * k_block)) * voxel_};
    if (!overlaps(box, program_.support)) return;
    std::vector<Interval> ranges;
    Code code = bound(program_, parent, box, ranges);
    if (ranges.back().hi < program_.threshold || ranges.back().lo > program_.threshold) return;
    if (code.steps.size() > 1) code = prune(program_, code, ranges);
    if (size == 1) return sample_block(first, code);
    const int half = size / 2;
    const auto child = [&](int i) { sample(first.offsetBy(i & 1 ? half : 0, i & 2 ? half : 0, i & 4 ? half : 0), half, code); };
    if (size > k_parallel_blocks)
      tbb::parallel_for(0, 8, child);
    else
      for (int i = 0; i < 8; ++i) child(i);
  }

  /// All samples; outside is positive, as OpenVDB has it.
  openvdb::FloatGrid::Ptr grid() {
    auto out = openvdb::FloatGrid::create(background());
    for (openvdb::FloatTree& tree : trees_) out->tree().merge(tree);
    out->setTransform(openvdb::math::Transform::createLinearTransform(voxel_));
    openvdb::tools::signedFloodFill(out->tree());
    return out;
  }

private:
  float background() const { return static_cast<float>(program_.threshold); }

  static bool overlaps(const Box3d& a, const Box3d& b) { return !intersect(a, b).is_empty(); }

  void sample_block(const openvdb::Coord& block, const Code& code) {
    const openvdb::Coord first(block.x() * k_block, block.y() * k_block, block.z() * k_block);
    Leaf* leaf = trees_.local().touchLeaf(first);
    for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) {
      const openvdb::Coord at = leaf->offsetToGlobalCoord(i);
      const double field = evaluate(program_, code, Point3<double>{at.x() * voxel_, at.y() * voxel_, at.z() * voxel_});
      leaf->setValueOn(i, static_cast<float>(program_.threshold - field));
    }
  }

  const FieldProgram& program_;
  double voxel_;
  tbb::enumerable_thread_specific<openvdb::FloatTree> trees_;
};

} // namespace

FieldMesh mesh_field(const FieldProgram& program, double voxel) {
  openvdb::initialize();
  Sampler sampler(program, voxel);
  const Vec3d lower = glm::floor(program.support.lower / (voxel * k_block)), upper = glm::ceil(program.support.upper / (voxel * k_block));
  const Vec3d extent = upper - lower;
  int size = 1;
  while (size < std::max({extent.x, extent.y, extent.z})) size *= 2;
  sampler.sample(openvdb::Coord(int(lower.x), int(lower.y), int(lower.z)), size, program.code);

  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec4I> quads;
  openvdb::tools::volumeToMesh(*sampler.grid(), points, quads);
  FieldMesh mesh;
  mesh.points.reserve(points.size()), mesh.triangles.reserve(6 * quads.size());
  for (const openvdb::Vec3s& p : points) mesh.points.emplace_back(p.x(), p.y(), p.z());
  for (const openvdb::Vec4I& q : quads)
    for (const int corner : {0, 1, 2, 0, 2, 3}) mesh.triangles.push_back(q[corner]);
  return mesh;
}

} // namespace kelpie
