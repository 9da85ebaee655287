#include "field/mesh/mesh.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "field/clouds/cloud_file.h"
#include "tests/support/mesh_text.h"

namespace kelpie {
namespace {

/// What must become of a file of the collection of broken meshes.
struct Expected {
  const char* file;
  ExitStatus status = ExitStatus::ok;
  const char* says = ""; ///< part of the error or of a warning
  size_t triangles = 0;  ///< 0: not checked
  int closed = -1;       ///< -1: not checked
  double volume = -1;    ///< -1: not checked
};

constexpr ExitStatus ok = ExitStatus::ok, bad = ExitStatus::bad_data;
constexpr double k_sphere = 4.047045; ///< of 320 triangles

const Expected k_expected[] = {
    {"open_box.obj", ok, "holes that were closed: 1", 12, 1, 8},
    {"single_triangle.obj", ok, "encloses no volume", 1, 0, 0},
    {"nonmanifold_edge.obj", ok, "edges with more than two triangles: 1", 5, 0},
    {"nonmanifold_vertex_two_cubes.off", ok, "vertices merged", 24, 1, 16},
    {"nested_hollow.off", ok, "", 24, 1, 7},
    {"self_intersecting_folded_sphere.obj", ok, "faced the wrong way: 320", 320, 1},
    {"flipped_all.obj", ok, "faced the wrong way: 320", 320, 1, k_sphere},
    {"flipped_random.ply", ok, "agree with their neighbours", 320, 1, k_sphere},
    {"duplicate_faces.obj", ok, "there twice: 40", 320, 1, k_sphere},
    {"triangle_soup_unwelded.stl", ok, "", 320, 1, k_sphere},
    {"unused_vertices.obj", ok, "", 320, 1, k_sphere},
    {"vertex_nan.obj", bad, ":11:16: a face uses this vertex"},
    {"vertex_huge.obj", bad, ":11:16: a face uses this vertex"},
    {"vertex_nan_binary.ply", bad, ": a face uses this vertex"},
    {"far_from_origin.obj", ok, "", 320, 1, k_sphere},
    {"all_same_point.obj", bad, "no face with three different vertices"},
    {"empty.off", bad, "the file is empty"},
    {"empty.stl", bad, "the file is empty"},
    {"zero_counts.off", bad, "no faces"},
    {"comments_only.obj", bad, "no faces"},
    {"truncated.off", bad, "cut off"},
    {"truncated_binary.stl", bad, "cut off"},
    {"stl_count_zero.stl", bad, "no facets"},
    {"stl_binary_starts_with_solid.stl", ok, "", 320, 1, k_sphere},
    {"off_count_lies.off", bad, "bytes follow"},
    {"ply_count_lies.ply", bad, "bytes follow"},
    {"index_zero.obj", bad, ":483:3: vertex index 0"},
    {"index_out_of_range.off", bad, ":484:7: there is no vertex 777777"},
    {"index_negative.off", bad, ":484:7: there is no vertex -1"},
    {"garbage.ply", bad, "PLY header"},
    {"wrong_extension_is_png.obj", bad, "not an OBJ file"},
    {"long_line.obj", ok, "two equal vertices", 320, 1, k_sphere},
    {"valid_crlf_bom.obj", ok, "", 12, 1, 8},
    {"valid_no_final_newline.obj", ok, "", 12, 1, 8},
    {"valid_quads.obj", ok, "", 12, 1, 8},
    {"valid_concave_ngon_star.off", ok, "", 92, 1, 3.726994},
    {"valid_line_continuation.obj", ok, "", 12, 1, 8},
    {"valid_big_endian.ply", ok, "", 320, 1, k_sphere},
    {"valid_ascii.stl", ok, "", 12, 1, 8},
    {"truncated_ascii.stl", bad, ":58:"},
};

std::string data_folder() {
  const char* folder = std::getenv("KELPIE_DATA");
  return folder ? folder : "";
}

void check(const Expected& e, const std::string& path) {
  Diagnostics diagnostics;
  std::string said;
  ExitStatus status = ExitStatus::ok;
  Mesh mesh;
  try {
    mesh = load_mesh(path, diagnostics);
  } catch (const Error& error) {
    status = error.status;
    said = error.what();
  }
  for (const Problem& p : diagnostics.warnings()) said += to_string(p) + "\n";
  ASSERT_EQ(status, e.status) << said;
  EXPECT_NE(said.find(e.says), std::string::npos) << said;
  if (status != ExitStatus::ok) return;
  EXPECT_TRUE(*e.says || said.empty()) << said;
  EXPECT_EQ(mesh.triangles.size(), e.triangles ? e.triangles : mesh.triangles.size());
  EXPECT_TRUE(e.closed < 0 || is_closed(mesh) == (e.closed == 1));
  EXPECT_NEAR(signed_volume(mesh), e.volume >= 0 ? e.volume : signed_volume(mesh), 1e-6);
  for (const Vec3d& p : mesh.positions) ASSERT_TRUE(glm::length(p) < 1e3);
}

TEST(Mesh, BrokenFilesBehaveAsTheirListSays) {
  if (data_folder().empty()) GTEST_SKIP() << "KELPIE_DATA is not set: no broken meshes to read";
  std::ifstream list(data_folder() + "/bad/MADE.tsv");
  ASSERT_TRUE(list);
  std::string line;
  std::getline(list, line);
  size_t seen = 0;
  while (std::getline(list, line)) {
    const std::string file = line.substr(0, line.find('\t'));
    SCOPED_TRACE(file);
    const auto e = std::find_if(std::begin(k_expected), std::end(k_expected), [&](const Expected& x) { return x.file == file; });
    if (e == std::end(k_expected))
      ADD_FAILURE() << "this file is not in the test's table";
    else
      check(*e, data_folder() + "/bad/" + file), ++seen;
  }
  EXPECT_EQ(seen, std::size(k_expected));
}

TEST(Mesh, RealMeshesLoadWithoutComplaint) {
  if (data_folder().empty()) GTEST_SKIP() << "KELPIE_DATA is not set: no meshes to read";
  for (const char* file : {"spot.obj", "bob_duck_low.ply", "dino.off", "linked_rings.off", "torus.obj"}) {
    SCOPED_TRACE(file);
    check({file, ok, "", 0, 1}, data_folder() + "/meshes/" + file);
  }
}

// --- what needs no files ---

Mesh parse(std::string_view text, const char* name, Diagnostics& diagnostics) { return parse_mesh(text, name, diagnostics); }

TEST(Mesh, ReadsObjByContentWithoutAnExtension) {
  Diagnostics diagnostics;
  const Mesh mesh = parse(k_obj_text, "shape", diagnostics);
  EXPECT_NEAR(signed_volume(mesh), 1.0 / 6, 1e-12);
  EXPECT_TRUE(is_closed(mesh));
  EXPECT_TRUE(diagnostics.warnings().empty());
}

TEST(Mesh, MissingFileIsMissingInput) {
  Diagnostics diagnostics;
  try {
    load_mesh("/nowhere/mesh.obj", diagnostics);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.status, ExitStatus::missing_input);
  }
}

TEST(Mesh, FaultsHaveTheirPosition) {
  Diagnostics diagnostics;
  try {
    parse("v 0 0 0\nv 1 zero 0\n", "a.obj", diagnostics);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(std::string(e.what()).substr(0, 11), "a.obj:2:5: ");
  }
}

/// Whatever the bytes, an Error or a mesh: never anything else. Each byte of a valid file is changed in turn.
TEST(Mesh, ChangedBytesNeverDoMoreThanFail) {
  const std::string files[][2] = {{"a.obj", k_obj_text}, {"a.off", k_off_text}, {"a.ply", k_ply_text}, {"a.stl", k_stl_text}};
  for (const auto& [name, text] : files)
    for (size_t i = 0; i < text.size(); ++i)
      for (const char c : {'9', '-', '\n', '\0', 'x', '\xff'}) {
        std::string changed = text;
        changed[i] = c;
        Diagnostics diagnostics;
        try {
          parse(changed, name.c_str(), diagnostics);
        } catch (const Error& e) {
          EXPECT_EQ(e.status, ExitStatus::bad_data);
        }
      }
}

TEST(Cloud, SurvivesWritingAndReading) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "kelpie_cloud_test";
  std::filesystem::create_directories(folder);
  const std::string path = (folder / "cloud.ply").string();
  const BlobCloud cloud{{Vec3(1, -2, 3), 0.5f, 2.f, Falloff::quartic}, {Vec3(0.1f, 1e-7f, -1e5f), 17.f, -0.25f, Falloff::quartic}};
  write_blob_cloud(path, cloud);
  const BlobCloud back = read_blob_cloud(path);
  ASSERT_EQ(back.size(), cloud.size());
  for (size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_EQ(back[i].centre, cloud[i].centre);
    EXPECT_EQ(back[i].radius, cloud[i].radius);
    EXPECT_EQ(back[i].weight, cloud[i].weight);
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder), {}), 1) << "a part file was left behind";
  std::filesystem::remove_all(folder);
}

TEST(Cloud, RefusesWhatIsNoCloud) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty float radius\n";
  const std::string path = ::testing::TempDir() + "/kelpie_no_cloud.ply";
  for (const std::string& text :
       {head + "end_header\n0 0 0 1\n", head + "property float weight\nend_header\n0 0 0 0 1\n",
        head + "property float weight\nend_header\n0 nan 0 1 1\n", head + "property float weight\nend_header\n0 0 0 1\n"}) {
    std::ofstream(path) << text;
    try {
      read_blob_cloud(path);
      ADD_FAILURE() << text;
    } catch (const Error& e) {
      EXPECT_EQ(e.status, ExitStatus::bad_data);
    }
  }
  std::filesystem::remove(path);
}

} // namespace
} // namespace kelpie
