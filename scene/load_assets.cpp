#include "scene/load_assets.h"

#include "field/clouds/cloud_file.h"

namespace kelpie {

namespace {

using CloudPtr = std::shared_ptr<const BlobCloud>;

class AssetLoader {
public:
  AssetLoader(const Document& document, bool use_cache, ProblemList& problems, Diagnostics& diagnostics)
      : document_(document), use_cache_(use_cache), problems_(problems), diagnostics_(diagnostics) {}

  void load(Blobs<AnimatedMode>& k, const JsonValue& source) { k.cloud = cloud(k.file, source, "file"); }

  void load(Liquid<AnimatedMode>& k, const JsonValue& source) {
    const CloudPtr from = cloud(k.from, source, "from"), to = cloud(k.to, source, "to");
    if (!from || !to) return;
    attempt(source, [&] { k.morph = std::make_shared<const LiquidMorph>(*from, *to, k.correspondence, k.volume); });
  }

  void load(TriangleMesh<AnimatedMode>& k, const JsonValue& source) {
    if (k.file.resolved.empty()) return;
    const auto [entry, is_new] = meshes_.try_emplace({k.file.resolved, {k.crease, k.weld}});
    std::shared_ptr<const SurfaceMesh>& loaded = entry->second;
    if (is_new)
      attempt(*source.find("file"), [&] {
        loaded = std::make_shared<const SurfaceMesh>(load_surface_mesh(k.file.resolved, {k.crease, k.weld}, diagnostics_));
      });
    k.mesh = loaded;
  }

  void load(Subdivision<AnimatedMode>& k, const JsonValue& source) {
    if (k.file.resolved.empty()) return;
    const auto [entry, is_new] = subdivisions_.try_emplace({k.file.resolved, k.levels});
    std::shared_ptr<const SubdivisionMesh>& loaded = entry->second;
    if (is_new)
      attempt(*source.find("file"),
              [&] { loaded = std::make_shared<const SubdivisionMesh>(load_subdivision_mesh(k.file.resolved, k.levels, diagnostics_)); });
    k.mesh = loaded;
  }

  void load(SdfMesh<AnimatedMode>& k, const JsonValue& source) {
    if (k.file.resolved.empty()) return;
    double reach = k.radius.at(0); // at any time; a constant has no keys
    for (const Key<float>& key : k.radius.keys()) reach = std::max(reach, double(key.value));
    const auto [entry, is_new] = grids_.try_emplace({k.file.resolved, {k.voxel, reach, k.weld}});
    std::shared_ptr<const DistanceGrid>& loaded = entry->second;
    if (is_new)
      attempt(*source.find("file"), [&] {
        loaded = load_distance_grid(k.file.resolved, {k.voxel, reach, k.weld}, use_cache_, diagnostics_);
      });
    k.grid = loaded;
  }

  /// All other kinds hold nothing.
  template <class Kind>
  void load(Kind&, const JsonValue&) {}

private:
  template <class Action>
  void attempt(const JsonValue& at, Action action) {
    try {
      action();
    } catch (const Error& e) {
      problems_.add(e, document_.where(at.at));
    }
  }

  /// Null where the file could not be read, now or when it was resolved.
  CloudPtr cloud(const AssetPath& file, const JsonValue& source, std::string_view key) {
    if (file.resolved.empty()) return nullptr;
    const auto [entry, is_new] = clouds_.try_emplace(file.resolved);
    CloudPtr& loaded = entry->second;
    if (is_new) attempt(*source.find(key), [&] { loaded = std::make_shared<const BlobCloud>(read_blob_cloud(file.resolved)); });
    return loaded;
  }

  const Document& document_;
  bool use_cache_;
  ProblemList& problems_;
  Diagnostics& diagnostics_;
  std::map<std::string, CloudPtr> clouds_;
  std::map<std::pair<std::string, SurfaceOptions>, std::shared_ptr<const SurfaceMesh>> meshes_;
  std::map<std::pair<std::string, int>, std::shared_ptr<const SubdivisionMesh>> subdivisions_; ///< by file and levels
  std::map<std::pair<std::string, MeshSampling>, std::shared_ptr<const DistanceGrid>> grids_;
};

} // namespace

void load_assets(const std::vector<ReadNode>& nodes, Scene& scene, const Document& document, bool use_cache, ProblemList& problems,
                 Diagnostics& diagnostics) {
  AssetLoader loader(document, use_cache, problems, diagnostics);
  for (const ReadNode& n : nodes) std::visit([&](auto& kind) { loader.load(kind, *n.source); }, n.node->kind);
  const JsonValue* shapes = document.root.find("shapes");
  for (size_t i = 0; i < scene.shapes.size(); ++i) // as many as the document has, in its order
    if (scene.shapes[i].geometry) {
      const JsonValue& source = *(*shapes->array())[i].find("geometry");
      std::visit([&](auto& kind) { loader.load(kind, source); }, *scene.shapes[i].geometry);
    }
}

} // namespace kelpie
