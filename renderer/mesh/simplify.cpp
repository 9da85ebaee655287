#include "renderer/mesh/simplify.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
// needs what is above
#include <OpenMesh/Core/Geometry/QuadricT.hh>

#include "base/parallel.h"
#include "field/mesh/triangle_tree.h"

namespace kelpie {

namespace {

struct Traits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
};
using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<Traits>;
using VertexHandle = HalfEdgeMesh::VertexHandle;
using FaceHandle = HalfEdgeMesh::FaceHandle;
using HalfEdge = HalfEdgeMesh::HalfedgeHandle;
using Quadric = OpenMesh::Geometry::Quadricd;

using Corners = std::array<Vec3d, 3>;

Vec3d vector(const OpenMesh::Vec3d& p) { return {p[0], p[1], p[2]}; }
Vec3d normal_of(const Corners& t) { return glm::cross(t[1] - t[0], t[2] - t[0]); }

/// Takes vertices away, each along an edge to a neighbour, the cheapest first. Can be copied.
class Collapser {
public:
  /// `scale` is a length that counts for little.
  Collapser(const Mesh& mesh, double scale) : scale_(scale) {
    mesh_.request_vertex_status(), mesh_.request_edge_status(), mesh_.request_halfedge_status(), mesh_.request_face_status();
    mesh_.add_property(quadric_), mesh_.add_property(stamp_), mesh_.add_property(gone_);
    mesh_.reserve(mesh.positions.size(), mesh.triangles.size() * 3 / 2, mesh.triangles.size());
    for (const Vec3d& p : mesh.positions) mesh_.property(quadric_, mesh_.add_vertex({p.x, p.y, p.z})).clear();
    const auto vertex = [](uint32_t i) { return VertexHandle(static_cast<int>(i)); };
    for (const Triangle& t : mesh.triangles) add_plane(mesh_.add_face(vertex(t[0]), vertex(t[1]), vertex(t[2])));
  }

  size_t triangle_count() const { return mesh_.n_faces(); }

  /// Until no more than `most` triangles are left, or every collapse takes a vertex that is gone farther than `tolerance` from the
  /// triangles that took its place.
  void run(double tolerance, size_t most) {
    tolerance_ = tolerance;
    std::priority_queue<Candidate>().swap(queue_);
    for (const VertexHandle v : mesh_.vertices()) offer(v, nullptr);
    for (size_t triangles = mesh_.n_faces(); triangles > most && !queue_.empty();) {
      const Candidate best = queue_.top();
      queue_.pop();
      const VertexHandle v = mesh_.from_vertex_handle(best.way);
      if (best.stamp != mesh_.property(stamp_, v) || mesh_.status(v).deleted()) continue;
      if (is_permitted(best.way))
        collapse(best.way), triangles -= 2;
      else
        offer(v, &best);
    }
    mesh_.garbage_collection();
  }

  /// Vertices in a box stay where they are. Whether there were any that could have gone.
  bool lock(const Box3d& box) {
    bool is_new = false;
    for (const VertexHandle v : mesh_.vertices())
      if (!mesh_.status(v).locked() && box.contains(place(v))) mesh_.status(v).set_locked(true), is_new = true;
    return is_new;
  }

  Mesh mesh() const {
    Mesh out;
    for (const VertexHandle v : mesh_.vertices()) out.positions.push_back(place(v));
    for (const FaceHandle f : mesh_.faces()) {
      Triangle& t = out.triangles.emplace_back();
      size_t i = 0;
      for (const VertexHandle v : mesh_.fv_range(f)) t[i++] = static_cast<uint32_t>(v.idx());
    }
    return out;
  }

private:
  /// A vertex and the edge along which it would go.
  struct Candidate {
    double cost;
    HalfEdge way;
    uint32_t stamp; ///< of the vertex, when its costs were these
    bool is_after(const Candidate& other) const { return std::pair(cost, way.idx()) > std::pair(other.cost, other.way.idx()); }
    friend bool operator<(const Candidate& a, const Candidate& b) { return a.is_after(b); } ///< the cheapest is on top
  };

  static constexpr double k_least_turn_cosine = 0.8; ///< no triangle turns by more than 37 degrees at once
  static constexpr size_t k_most_remembered = 16;
  /// Of the tolerance: what is nearer is forgotten.
  static constexpr double k_negligible = 0.01;
  /// Of the scale: no triangle is thinner.
  static constexpr double k_thinnest = 0.01;
  /// Where all is flat short edges go first, so that no vertex gathers all triangles.
  static constexpr double k_length_weight = 1e-3;

  Vec3d place(VertexHandle v) const { return vector(mesh_.point(v)); }

  Corners corners_of(FaceHandle face) const {
    Corners out;
    size_t i = 0;
    for (const VertexHandle v : mesh_.fv_range(face)) out[i++] = place(v);
    return out;
  }

  void add_plane(FaceHandle face) {
    const Corners t = corners_of(face);
    const Vec3d normal = normal_of(t);
    const double twice_area = glm::length(normal);
    if (!(twice_area > 0)) return;
    const Vec3d n = normal / twice_area;
    Quadric q(n.x, n.y, n.z, -glm::dot(n, t[0]));
    q *= 0.5 * twice_area;
    for (const VertexHandle v : mesh_.fv_range(face)) mesh_.property(quadric_, v) += q;
  }

  double cost_of(HalfEdge way) const {
    const VertexHandle from = mesh_.from_vertex_handle(way), to = mesh_.to_vertex_handle(way);
    Quadric q = mesh_.property(quadric_, from);
    q += mesh_.property(quadric_, to);
    const Vec3d edge = place(to) - place(from);
    return std::max(0.0, q(mesh_.point(to))) + k_length_weight * scale_ * scale_ * glm::dot(edge, edge);
  }

  /// Queues the cheapest way of a vertex after another, if there is one.
  void offer(VertexHandle v, const Candidate* after) {
    if (mesh_.status(v).locked()) return;
    Candidate best{0, HalfEdge(), mesh_.property(stamp_, v)};
    for (const HalfEdge way : mesh_.voh_range(v)) {
      const Candidate candidate{cost_of(way), way, mesh_.property(stamp_, v)};
      if (after && !candidate.is_after(*after)) continue;
      if (!best.way.is_valid() || best.is_after(candidate)) best = candidate;
    }
    if (best.way.is_valid()) queue_.push(best);
  }

  /// Fills `moved_` with the triangles around the vertex that stay, as they will be.
  bool is_permitted(HalfEdge way) {
    if (!mesh_.is_collapse_ok(way) || leaves_a_pillow(way)) return false;
    const VertexHandle from = mesh_.from_vertex_handle(way), to = mesh_.to_vertex_handle(way);
    moved_.clear(), moved_faces_.clear(), points_.clear();
    points_.push_back(place(from));
    for (const FaceHandle face : mesh_.vf_range(from)) {
      points_.insert(points_.end(), mesh_.property(gone_, face).begin(), mesh_.property(gone_, face).end());
      Corners now, then;
      size_t i = 0;
      bool stays = true;
      for (const VertexHandle v : mesh_.fv_range(face)) {
        stays = stays && v != to;
        now[i] = place(v), then[i++] = place(v == from ? to : v);
      }
      if (!stays) continue;
      if (!may_become(now, then)) return false;
      moved_.push_back(then), moved_faces_.push_back(face);
    }
    for (const Vec3d& p : points_)
      if (!is_near(p)) return false;
    return true;
  }

  /// Two triangles of the same corners: what a tetrahedron would become.
  bool leaves_a_pillow(HalfEdge way) const {
    const auto loses_a_way = [&](HalfEdge side) { return mesh_.valence(mesh_.opposite_vh(side)) <= 3; };
    return loses_a_way(way) || loses_a_way(mesh_.opposite_halfedge_handle(way));
  }

  bool may_become(const Corners& now, const Corners& then) const {
    const Vec3d before = normal_of(now), after = normal_of(then);
    const double length = glm::length(after);
    if (glm::dot(before, after) < k_least_turn_cosine * length * glm::length(before)) return false;
    const double longest = std::max({glm::distance(then[0], then[1]), glm::distance(then[1], then[2]), glm::distance(then[2], then[0])});
    return length > k_thinnest * scale_ * longest;
  }

  bool is_near(const Vec3d& p) const {
    return std::any_of(moved_.begin(), moved_.end(), [&](const Corners& t) { return distance_to_triangle(t, p) <= tolerance_; });
  }

  /// What is_permitted() has just permitted.
  void collapse(HalfEdge way) {
    const VertexHandle from = mesh_.from_vertex_handle(way), to = mesh_.to_vertex_handle(way);
    mesh_.property(quadric_, to) += mesh_.property(quadric_, from);
    remember();
    mesh_.collapse(way);
    ++mesh_.property(stamp_, to);
    offer(to, nullptr);
    for (const VertexHandle v : mesh_.vv_range(to)) ++mesh_.property(stamp_, v), offer(v, nullptr);
  }

  /// Shares the places that have gone out to the triangles that take theirs; each remembers the farthest.
  void remember() {
    for (const FaceHandle face : moved_faces_) mesh_.property(gone_, face).clear();
    for (const Vec3d& p : points_) {
      size_t nearest = 0;
      double least = std::numeric_limits<double>::infinity();
      for (size_t i = 0; i < moved_.size(); ++i)
        if (const double d = distance_to_triangle(moved_[i], p); d < least) nearest = i, least = d;
      if (least > k_negligible * tolerance_) add_gone(mesh_.property(gone_, moved_faces_[nearest]), moved_[nearest], p, least);
    }
  }

  static void add_gone(std::vector<Vec3d>& gone, const Corners& triangle, const Vec3d& p, double distance) {
    if (gone.size() < k_most_remembered) {
      gone.push_back(p);
      return;
    }
    const auto nearest = std::min_element(gone.begin(), gone.end(), [&](const Vec3d& a, const Vec3d& b) {
      return distance_to_triangle(triangle, a) < distance_to_triangle(triangle, b);
    });
    if (distance_to_triangle(triangle, *nearest) < distance) *nearest = p;
  }

  HalfEdgeMesh mesh_;
  OpenMesh::VPropHandleT<Quadric> quadric_;         ///< of the planes of all triangles that a vertex stands for, by their areas
  OpenMesh::VPropHandleT<uint32_t> stamp_;          ///< how often a vertex's costs have changed
  OpenMesh::FPropHandleT<std::vector<Vec3d>> gone_; ///< places of vertices that are gone
  std::priority_queue<Candidate> queue_;
  double scale_, tolerance_ = 0;
  // What is_permitted() found:
  std::vector<Corners> moved_;
  std::vector<FaceHandle> moved_faces_;
  std::vector<Vec3d> points_;
};

/// A mesh that is to be simplified, with what it takes to judge the result.
struct Original {
  const Mesh& mesh;
  TriangleTree tree;
  const ExactLattice& lattice;
};

/// Boxes of places where two triangles of a mesh meet.
void add_meetings(const Mesh& mesh, const ExactLattice& lattice, std::vector<Box3d>& out) {
  const auto box_of = [&](uint32_t triangle) {
    Box3d box;
    for (const uint32_t corner : mesh.triangles[triangle]) box.extend(mesh.positions[corner]);
    return box;
  };
  for (const auto& [a, b] : self_intersections(mesh, lattice)) out.push_back(intersect(box_of(a), box_of(b)));
}

/// Boxes around those of some places that are farther from a mesh than a tolerance, as large as the distance.
void add_far_places(const std::vector<Vec3d>& places, const TriangleTree& mesh, double tolerance, std::vector<Box3d>& out) {
  std::vector<double> distances(places.size());
  parallel_for(size_t(0), places.size(), [&](size_t i) { distances[i] = mesh.distance(places[i], 100 * tolerance); });
  for (size_t i = 0; i < places.size(); ++i)
    if (distances[i] > tolerance) out.push_back(Box3d{places[i], places[i]}.padded(distances[i] - tolerance));
}

/// Where a simplified mesh is not good enough: triangles meet, vertices of the original are farther from it than the tolerance, or its
/// triangles (their middles and those of their sides) from the original.
std::vector<Box3d> faults_of(const Mesh& mesh, const Original& original, double tolerance) {
  std::vector<Box3d> out;
  add_meetings(mesh, original.lattice, out);
  if (!std::isfinite(tolerance)) return out;
  add_far_places(original.mesh.positions, TriangleTree(mesh), tolerance, out);
  std::vector<Vec3d> middles;
  for (const auto& [i, j, k] : mesh.triangles) {
    const Vec3d &a = mesh.positions[i], &b = mesh.positions[j], &c = mesh.positions[k];
    middles.insert(middles.end(), {(a + b + c) / 3.0, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)});
  }
  add_far_places(middles, original.tree, tolerance, out);
  return out;
}

/// Advances a collapser from where it has come to, again and again, with more and more of it locked, until there are no faults by the
/// tolerance (infinite: of triangles that meet); or leaves it as it is. `advance(collapser)` returns the tolerance.
template <class Advance>
Collapser advanced(Collapser start, const Original& original, double around, const Advance& advance) {
  constexpr double k_wider = 1.5; // each round: fewer rounds, and a few triangles more
  while (true) {
    Collapser collapser = start;
    const double tolerance = advance(collapser);
    const std::vector<Box3d> faults = faults_of(collapser.mesh(), original, tolerance);
    if (faults.empty() || collapser.triangle_count() == start.triangle_count()) return collapser;
    for (bool is_new = false; !is_new; around *= k_wider)
      for (const Box3d& fault : faults) is_new = start.lock(fault.padded(around)) || is_new;
  }
}

} // namespace

Mesh simplified(const Mesh& mesh, const ExactLattice& lattice, const SimplifyOptions& options) {
  constexpr size_t k_safe_part = 16; // so few triangles, and still hardly a fault: what follows is cheap to repeat
  const Original original{mesh, TriangleTree(mesh), lattice};
  const double tolerance = options.tolerance;
  Collapser rough = advanced(Collapser(mesh, tolerance), original, tolerance, [&](Collapser& collapser) {
    collapser.run(tolerance, mesh.triangles.size() / k_safe_part);
    return tolerance;
  });
  return advanced(std::move(rough), original, tolerance,
                  [&](Collapser& collapser) {
                    collapser.run(tolerance, 0);
                    if (collapser.triangle_count() <= options.most_triangles) return tolerance;
                    const double endless = std::numeric_limits<double>::infinity();
                    collapser.run(endless, options.most_triangles);
                    return endless;
                  })
      .mesh();
}

} // namespace kelpie
