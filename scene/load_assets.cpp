#include "scene/load_assets.h"

#include "field/clouds/cloud_file.h"

namespace kelpie {

namespace {

using CloudPtr = std::shared_ptr<const BlobCloud>;

class AssetLoader {
public:
  AssetLoader(const Document& document, ProblemList& problems) : document_(document), problems_(problems) {}

  void load(Blobs<AnimatedMode>& k, const JsonValue& source) { k.cloud = cloud(k.file, source, "file"); }

  void load(Liquid<AnimatedMode>& k, const JsonValue& source) {
    const CloudPtr from = cloud(k.from, source, "from"), to = cloud(k.to, source, "to");
    if (!from || !to) return;
    attempt(source, [&] { k.morph = std::make_shared<const LiquidMorph>(*from, *to, k.correspondence, k.volume); });
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
  ProblemList& problems_;
  std::map<std::string, CloudPtr> clouds_;
};

} // namespace

void load_assets(const std::vector<ReadNode>& nodes, const Document& document, ProblemList& problems) {
  AssetLoader loader(document, problems);
  for (const ReadNode& n : nodes) std::visit([&](auto& kind) { loader.load(kind, *n.source); }, n.node->kind);
}

} // namespace kelpie
