#include "renderer/output/mesh_3mf.h"

#include <map>
#include <memory>
#include <new>

#include <fmt/format.h>
#include <zip.h>

namespace kelpie {

namespace {

constexpr const char* k_content_types = R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
)";
constexpr const char* k_relationships = R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
)";

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) switch (c) {
    case '&': out += "&amp;"; break;
    case '<': out += "&lt;"; break;
    case '"': out += "&quot;"; break;
    default: out += c;
    }
  return out;
}

void append_object(const MeshObject& object, size_t id, std::string& out) {
  const auto print = [&]<class... T>(fmt::format_string<T...> text, T&&... values) {
    fmt::format_to(std::back_inserter(out), text, std::forward<T>(values)...);
  };
  std::map<std::array<uint8_t, 3>, size_t> places; // of the colours in the group
  print("<m:colorgroup id=\"{}\">\n", 2 * id);
  for (const auto& colour : object.colours)
    if (places.try_emplace(colour, places.size()).second)
      print("<m:color color=\"#{:02X}{:02X}{:02X}\"/>\n", colour[0], colour[1], colour[2]);
  print("</m:colorgroup>\n<object id=\"{}\" type=\"model\" name=\"{}\" pid=\"{}\" pindex=\"0\"><mesh>\n<vertices>\n", 2 * id + 1,
        escaped(object.name), 2 * id);
  for (const Vec3d& p : object.mesh.positions) print("<vertex x=\"{}\" y=\"{}\" z=\"{}\"/>\n", float(p.x), float(p.y), float(p.z));
  print("</vertices>\n<triangles>\n");
  for (const Triangle& t : object.mesh.triangles) {
    print("<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"", t[0], t[1], t[2]);
    const auto colour = [&](size_t corner) { return places.at(object.colours[t[corner]]); };
    print(" pid=\"{}\" p1=\"{}\" p2=\"{}\" p3=\"{}\"/>\n", 2 * id, colour(0), colour(1), colour(2));
  }
  print("</triangles>\n</mesh></object>\n");
}

std::string model_text(std::span<const MeshObject> objects) {
  std::string out = R"(<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02">
<metadata name="Application">kelpie</metadata>
<resources>
)";
  for (size_t i = 0; i < objects.size(); ++i) append_object(objects[i], i + 1, out);
  out += "</resources>\n<build>\n";
  for (size_t i = 0; i < objects.size(); ++i) fmt::format_to(std::back_inserter(out), "<item objectid=\"{}\"/>\n", 2 * (i + 1) + 1);
  return out + "</build>\n</model>\n";
}

/// A zip archive in memory; what libzip does not do is for want of memory.
class Archive {
public:
  Archive() : source_(zip_source_buffer_create(nullptr, 0, 0, nullptr), zip_source_free) {
    check(source_ != nullptr);
    zip_source_keep(source_.get()); // closing the archive gives one of both away
    archive_ = zip_open_from_source(source_.get(), ZIP_TRUNCATE, nullptr);
    check(archive_ != nullptr);
  }
  Archive(const Archive&) = delete;
  ~Archive() {
    if (archive_) zip_discard(archive_);
  }

  /// The text must stay until the archive is closed.
  void add(const char* name, std::string_view text) {
    zip_source_t* file = zip_source_buffer(archive_, text.data(), text.size(), 0);
    const zip_int64_t index = file ? zip_file_add(archive_, name, file, ZIP_FL_ENC_UTF_8) : -1;
    check(index >= 0);
    constexpr time_t k_some_time = 315532800 + 86400; // a day after the first that a zip archive knows, wherever that is
    zip_file_set_mtime(archive_, zip_uint64_t(index), k_some_time, 0);
  }

  std::string close() {
    check(zip_close(archive_) == 0);
    archive_ = nullptr;
    zip_stat_t stat;
    check(zip_source_stat(source_.get(), &stat) == 0 && zip_source_open(source_.get()) == 0);
    std::string bytes(stat.size, '\0');
    const bool is_read = zip_source_read(source_.get(), bytes.data(), bytes.size()) == zip_int64_t(bytes.size());
    zip_source_close(source_.get());
    check(is_read);
    return bytes;
  }

private:
  static void check(bool is_done) {
    if (!is_done) throw std::bad_alloc();
  }

  std::unique_ptr<zip_source_t, void (*)(zip_source_t*)> source_;
  zip_t* archive_ = nullptr;
};

} // namespace

std::string threemf_bytes(std::span<const MeshObject> objects) {
  const std::string model = model_text(objects);
  Archive archive;
  archive.add("[Content_Types].xml", k_content_types);
  archive.add("_rels/.rels", k_relationships);
  archive.add("3D/3dmodel.model", model);
  return archive.close();
}

} // namespace kelpie
