#include "scene/load_assets.h"

#include <algorithm>

#include "field/clouds/cloud_file.h"

namespace kelpie {

namespace {

template <class Kind>
constexpr bool k_names_files = std::apply([](const auto&... row) { return (... || std::is_same_v<MemberOf<decltype(row)>, AssetPath>); },
                                          Kind::parameters());

using CloudPtr = std::shared_ptr<const BlobCloud>;

class AssetLoader {
public:
  AssetLoader(const RecordReader& reader, bool use_cache, ProblemList& problems, Diagnostics& diagnostics)
      : reader_(reader), use_cache_(use_cache), problems_(problems), diagnostics_(diagnostics) {}

  /// Of a kind that stands at `where`. One that has assets and no overload below does not compile, nor does one that names files and
  /// has none.
  template <class Kind>
  void load_assets_of(Kind& kind, const SourcePosition& where) {
    static_assert(HasAssets<Kind> == k_names_files<Kind>, "what files hold is declared by assets()");
    if constexpr (HasAssets<Kind>) load(kind, where);
  }

private:
  void load(Blobs<AnimatedMode>& k, const SourcePosition&) { k.cloud = cloud(k.file); }

  void load(Liquid<AnimatedMode>& k, const SourcePosition& where) {
    std::vector<CloudPtr> row{cloud(k.from)};
    for (const AssetPath& file : k.through) row.push_back(cloud(file));
    row.push_back(cloud(k.to));
    std::vector<const BlobCloud*> clouds;
    for (const CloudPtr& one : row) clouds.push_back(one.get());
    if (std::count(clouds.begin(), clouds.end(), nullptr) > 0) return;
    attempt(where, [&] { k.morph = std::make_shared<const LiquidChain>(clouds, k.correspondence, k.volume, k.ends); });
  }

  void load(TriangleMesh<AnimatedMode>& k, const SourcePosition&) {
    if (k.file.resolved.empty()) return;
    const auto [entry, is_new] = meshes_.try_emplace({k.file.resolved, {k.crease, k.weld}});
    std::shared_ptr<const SurfaceMesh>& loaded = entry->second;
    if (is_new)
      attempt(reader_.where_named(k.file), [&] {
        loaded = std::make_shared<const SurfaceMesh>(load_surface_mesh(k.file.resolved, {k.crease, k.weld}, diagnostics_));
      });
    k.mesh = loaded;
  }

  void load(Subdivision<AnimatedMode>& k, const SourcePosition&) {
    if (k.file.resolved.empty()) return;
    const auto [entry, is_new] = subdivisions_.try_emplace({k.file.resolved, k.levels});
    std::shared_ptr<const SubdivisionMesh>& loaded = entry->second;
    if (is_new)
      attempt(reader_.where_named(k.file),
              [&] { loaded = std::make_shared<const SubdivisionMesh>(load_subdivision_mesh(k.file.resolved, k.levels, diagnostics_)); });
    k.mesh = loaded;
  }

  void load(SdfMesh<AnimatedMode>& k, const SourcePosition&) {
    if (k.file.resolved.empty()) return;
    double reach = k.radius.is_constant() ? double(k.radius.at(0)) : 0; // at any time
    for (const double frame : k.radius.frames()) reach = std::max(reach, double(k.radius.at(frame)));
    const MeshSampling how{k.voxel, reach, k.weld, k.crease};
    const auto [entry, is_new] = grids_.try_emplace({k.file.resolved, how});
    std::shared_ptr<const DistanceGrid>& loaded = entry->second;
    if (is_new) attempt(reader_.where_named(k.file), [&] { loaded = load_distance_grid(k.file.resolved, how, use_cache_, diagnostics_); });
    k.grid = loaded;
  }

  template <class Action>
  void attempt(const SourcePosition& where, Action action) {
    try {
      action();
    } catch (const Error& e) {
      problems_.add(e, where);
    }
  }

  /// Null where the file could not be read, now or when it was resolved.
  CloudPtr cloud(const AssetPath& file) {
    if (file.resolved.empty()) return nullptr;
    const auto [entry, is_new] = clouds_.try_emplace(file.resolved);
    CloudPtr& loaded = entry->second;
    if (is_new) attempt(reader_.where_named(file), [&] { loaded = std::make_shared<const BlobCloud>(read_blob_cloud(file.resolved)); });
    return loaded;
  }

  const RecordReader& reader_;
  bool use_cache_;
  ProblemList& problems_;
  Diagnostics& diagnostics_;
  std::map<std::string, CloudPtr> clouds_;
  std::map<std::pair<std::string, SurfaceOptions>, std::shared_ptr<const SurfaceMesh>> meshes_;
  std::map<std::pair<std::string, int>, std::shared_ptr<const SubdivisionMesh>> subdivisions_; ///< by file and levels
  std::map<std::pair<std::string, MeshSampling>, std::shared_ptr<const DistanceGrid>> grids_;
};

} // namespace

void load_assets(const RecordReader& reader, Scene& scene, bool use_cache, ProblemList& problems, Diagnostics& diagnostics) {
  AssetLoader loader(reader, use_cache, problems, diagnostics);
  for (const ReadNode& n : reader.nodes()) std::visit([&](auto& kind) { loader.load_assets_of(kind, n.node->where); }, n.node->kind);
  for (Shape& shape : scene.shapes)
    if (shape.geometry) std::visit([&](auto& kind) { loader.load_assets_of(kind, shape.where); }, *shape.geometry);
}

} // namespace kelpie
