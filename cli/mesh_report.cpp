#include "cli/mesh_report.h"

#include <cmath>

#include <fmt/format.h>

#include "cli/json_values.h"

namespace kelpie {

namespace {

std::string counted(size_t n, const char* one, const char* many) { return fmt::format("{} {}", n, n == 1 ? one : many); }

Json json_of(const std::vector<Piece>& pieces) {
  Json out = Json::array();
  for (const Piece& p : pieces)
    out.push_back({{"volume", std::abs(p.volume)}, {"lower", json_point(p.box.lower)}, {"upper", json_point(p.box.upper)}});
  return out;
}

} // namespace

std::string mesh_summary(std::span<const MeshObject> objects, std::span<const Survey> surveys) {
  std::string out;
  for (size_t i = 0; i < objects.size(); ++i) {
    const Survey& s = surveys[i];
    const Vec3d size = s.box.extent();
    out +=
        fmt::format("{}: {} triangles, {:.4g} x {:.4g} x {:.4g} mm, {}{}, volume {:.4g} cm3, area {:.4g} cm2, thinnest wall {:.3g} mm at "
                    "({:.4g}, {:.4g}, {:.4g})\n",
                    objects[i].name, objects[i].mesh.triangles.size(), size.x, size.y, size.z, counted(s.pieces.size(), "piece", "pieces"),
                    s.cavities.empty() ? "" : ", " + counted(s.cavities.size(), "cavity", "cavities"), s.volume / 1000, s.area / 100,
                    s.thinnest, s.thinnest_at.x, s.thinnest_at.y, s.thinnest_at.z);
  }
  return out;
}

std::string mesh_json(const MeshedFrame& frame, std::span<const Survey> surveys) {
  Json objects = Json::array();
  for (size_t i = 0; i < frame.objects.size(); ++i) {
    const Survey& s = surveys[i];
    objects.push_back({{"name", frame.objects[i].name},
                       {"triangles", frame.objects[i].mesh.triangles.size()},
                       {"vertices", frame.objects[i].mesh.positions.size()},
                       {"lower", json_point(s.box.lower)},
                       {"upper", json_point(s.box.upper)},
                       {"volume", s.volume},
                       {"area", s.area},
                       {"pieces", json_of(s.pieces)},
                       {"cavities", json_of(s.cavities)},
                       {"thinnest_wall", {{"thickness", s.thinnest}, {"at", json_point(s.thinnest_at)}}}});
  }
  return Json{{"version", KELPIE_VERSION}, {"unit", "mm"}, {"tolerance", frame.tolerance}, {"objects", std::move(objects)}}.dump(2) + "\n";
}

} // namespace kelpie
