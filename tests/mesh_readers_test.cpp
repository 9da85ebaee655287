// What other programs write: each variant of a format reads as the plain file does, or is refused with its place.
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "field/mesh/mesh.h"
#include "tests/support/mesh_text.h"

namespace kelpie {
namespace {

std::string with_line_ends(std::string text, const std::string& end) {
  std::string out;
  for (const char c : text) out += c == '\n' ? end : std::string(1, c);
  return out;
}

std::string upper_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) text.replace(at, from.size(), to);
  return text;
}

/// The text is read without a word as the tetrahedron, whatever the name says.
void expect_tetrahedron(const std::string& text, const std::string& name) {
  SCOPED_TRACE(name + ":\n" + text);
  Diagnostics diagnostics;
  try {
    const Mesh mesh = parse_mesh(text, name, diagnostics);
    EXPECT_EQ(mesh.triangles.size(), 4u);
    EXPECT_TRUE(is_closed(mesh));
    EXPECT_NEAR(signed_volume(mesh), 1.0 / 6, 1e-12);
  } catch (const Error& e) {
    ADD_FAILURE() << e.what();
  }
  for (const Problem& p : diagnostics.warnings()) ADD_FAILURE() << to_string(p);
}

std::string error_of(const std::string& text, const std::string& name) {
  Diagnostics diagnostics;
  try {
    parse_mesh(text, name, diagnostics);
    return "";
  } catch (const Error& e) {
    EXPECT_EQ(e.status, ExitStatus::bad_data);
    return e.what();
  }
}

TEST(MeshReaders, LineEndsPaddingAndCaseDoNotMatter) {
  const std::pair<std::string, std::string> files[] = {
      {"a.obj", k_obj_text}, {"a.off", k_off_text}, {"a.ply", k_ply_text}, {"a.stl", k_stl_text}};
  for (const auto& [name, text] : files) {
    for (const std::string end : {"\n", "\r\n", "\r", "\n\n", " \t\n"})
      if (!(name == "a.ply" && end == "\n\n")) expect_tetrahedron(with_line_ends(text, end), name);
    expect_tetrahedron("\xef\xbb\xbf" + text, name);
    expect_tetrahedron("\n \r\n\n" + text, name);
    expect_tetrahedron(text + '\x1a', name);
    expect_tetrahedron(text + std::string(517, '\0'), name);
    expect_tetrahedron(text + "\x1a\x1a" + std::string(3, '\0'), name);
    expect_tetrahedron(text.substr(0, text.size() - 1), name);
    expect_tetrahedron(upper_case(text), name);
    EXPECT_NE(error_of("\xff\xfe" + text, name).find("UTF-16"), std::string::npos);
  }
}

TEST(MeshReaders, ObjAsOthersWriteIt) {
  const std::string& text = k_obj_text;
  expect_tetrahedron("# layer: C:\\scenes\\ring\\\n" + text, "a.obj");
  expect_tetrahedron(replaced(text, "v 1 0 0", "v 1 0 0 # a corner \\"), "a.obj");
  expect_tetrahedron("g C:\\scenes\\\nusemtl a\\\nmtllib D:\\\n" + text, "a.obj");
  expect_tetrahedron(replaced(text, "f 1 3 2", "f 1 \\\n3 \\\r\n2"), "a.obj");
  expect_tetrahedron(replaced(text, "f 1 3 2", "f -4 -2 -3"), "a.obj");
  expect_tetrahedron(replaced(text, "f 1 3 2", "vt 0 0\nvn -1.#IND00 nan 1.#QNAN\nf 1//1 3//1 2//1\nl 1 2\np 1\ns off"), "a.obj");
  expect_tetrahedron(replaced(text, "f 1 3 2", "f 1/1/1 3/1/1 2/1/1"), "a.obj");
  expect_tetrahedron(replaced(text, "v 1 0 0", "v 1 -1e-400 +0.000e+00 0.5 0.25 -1.#IND"), "a.obj");
  expect_tetrahedron("v nan inf 1e999\nv -1.#IND00 1.#INF 0\n" +
                         replaced(text, "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4", "f 3 5 4\nf 3 4 6\nf 3 6 5\nf 4 5 6"),
                     "a.obj");
}

TEST(MeshReaders, OffAsOthersWriteIt) {
  const std::string& text = k_off_text;
  expect_tetrahedron(replaced(text, "OFF\n", "OFF"), "a.off");
  expect_tetrahedron(replaced(text, "OFF\n", "OFF "), "a");
  expect_tetrahedron(replaced(text, "OFF\n", "# made by hand\n\nOFF # the header\n# counts:\n"), "a");
  expect_tetrahedron(replaced(text, "OFF\n", ""), "a.off");
  expect_tetrahedron(replaced(text, "4 4 6\n", "4 4\n"), "a.off");
  expect_tetrahedron(replaced(text, "4 4 6\n", "4\n4\n6\n"), "a.off");
  const std::string coloured = replaced(replaced(text, "0 0 1\n", "0 0 1 255 0 0 255\n"), "3 0 2 1", "3 0 2 1 0.5 0.5 nan");
  expect_tetrahedron(coloured, "a.off");
  for (const char* prefix : {"C", "N", "CN", "ST", "STCN", "c"}) expect_tetrahedron(prefix + coloured, "a.off");
  const std::string faces = "\n3 0 2 1 9\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"; // several vertices a line: the header says what they have
  expect_tetrahedron("OFF 4 4 6\n0 0 0 1 0 0 0 1 0 0 0 1" + faces, "a.off");
  expect_tetrahedron("NOFF 4 4 6\n0 0 0 0 0 1 1 0 0 0 0 1 0 1 0 0 0 1 0 0 1 -nan(ind) 0 1" + faces, "a.off");
  EXPECT_EQ(error_of(replaced(text, "OFF\n", "OFF BINARY\n"), "a.off"), "a.off:1:5: binary OFF files are not supported");
  EXPECT_NE(error_of("4" + text, "a.off").find("a.off:1:1: this variant of OFF is not supported"), std::string::npos);
  EXPECT_NE(error_of(replaced(text, "OFF\n", "nOFF\n"), "a.off").find("a.off:1:1: this variant of OFF is not supported"),
            std::string::npos);
}

TEST(MeshReaders, StlAsOthersWriteIt) {
  const std::string& text = k_stl_text;
  expect_tetrahedron(replaced(text, "endloop", "end loop"), "a.stl");
  expect_tetrahedron(replaced(replaced(text, "endsolid", "End Solid"), "endfacet", "END  FACET"), "a");
  expect_tetrahedron(replaced(text, "outer loop", "outerloop"), "a.stl");
  expect_tetrahedron(replaced(text, "normal 0 0 0", "normal -1.#IND00 1.#QNAN nan"), "a.stl");
  expect_tetrahedron(replaced(text, "normal 0 0 0\nouter", "normal\n0 0 1 outer"), "a.stl");
  expect_tetrahedron(replaced(text, "solid a\nfacet", "solid vertex facet \xe4 \"end\" loop\\\nfacet"), "a.stl");
  expect_tetrahedron(replaced(text, "solid a\nfacet", "solid\ncolor 1 0.5 0\nfacet"), "a.stl");
  expect_tetrahedron("# by hand\n\n" + text, "a.stl");
  const size_t half = text.find("facet normal", text.size() / 2);
  expect_tetrahedron(text.substr(0, half) + "endsolid a\n\nsolid b\n" + text.substr(half), "a.stl");
  EXPECT_EQ(error_of("this is no mesh\n", "a.stl"),
            "a.stl:1:1: neither a binary STL file (it is text), nor an ASCII one (it does not begin with \"solid\")");
  EXPECT_EQ(error_of(replaced(text, "vertex 1 0 0", "vertex 1 0"), "a.stl").substr(0, 12), "a.stl:6:11: ");
}

template <class T>
void append(std::string& bytes, T value, bool is_big = false) {
  std::array<char, sizeof(T)> raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if (is_big) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

constexpr float k_vertices[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
constexpr int k_faces[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

TEST(MeshReaders, BinaryStlMayBeginWithSolidAndHaveBytesBehind) {
  std::string bytes = "solid facet";
  bytes.resize(80, ' ');
  append(bytes, uint32_t{4});
  for (const auto& face : k_faces) {
    for (int k = 0; k < 3; ++k) append(bytes, std::numeric_limits<float>::quiet_NaN()); // the normal
    for (const int v : face)
      for (const float x : k_vertices[v]) append(bytes, x);
    append(bytes, uint16_t{0});
  }
  for (const char* name : {"a.stl", "a"}) {
    expect_tetrahedron(bytes, name);
    expect_tetrahedron(bytes + std::string("\0\x1a", 2), name);
  }
  append(bytes, std::numeric_limits<float>::quiet_NaN());
  std::string spoilt = bytes;
  const float infinite = std::numeric_limits<float>::infinity();
  std::memcpy(spoilt.data() + 84 + 50 + 12, &infinite, 4);
  EXPECT_EQ(error_of(spoilt, "a.stl").substr(0, 48), "a.stl: vertex 3: a face uses this vertex, but it");
}

template <class Index, class Count>
std::string binary_ply(const char* index, const char* count, bool is_big, const std::string& end) {
  std::string bytes = std::string("ply\nformat binary_") + (is_big ? "big" : "little") +
                      "_endian 1.0\ncomment before\nobj_info x\nelement grid 1\nproperty list uchar double cells\nelement vertex 4\n"
                      "property uchar red\nproperty float x\nproperty float y\nproperty float z\ncomment between\nelement face 4\n"
                      "property float quality\nproperty list " +
                      std::string(count) + " " + index + " vertex_index\nelement edge 1\nproperty int a\nend_header\n";
  bytes = with_line_ends(bytes, end);
  append(bytes, uint8_t{1}), append(bytes, 0.5, is_big);
  for (const auto& v : k_vertices) {
    append(bytes, uint8_t{10});
    for (const float x : v) append(bytes, x, is_big);
  }
  for (const auto& face : k_faces) {
    append(bytes, std::numeric_limits<float>::quiet_NaN(), is_big);
    append(bytes, Count{3}, is_big);
    for (const int v : face) append(bytes, static_cast<Index>(v), is_big);
  }
  append(bytes, int32_t{0}, is_big);
  return bytes;
}

TEST(MeshReaders, PlyListsOfAnyWidthAmongOtherElements) {
  for (const bool is_big : {false, true})
    for (const char* end : {"\n", "\r\n", "\r"}) {
      expect_tetrahedron(binary_ply<int8_t, uint8_t>("char", "uchar", is_big, end), "a.ply");
      expect_tetrahedron(binary_ply<uint16_t, int16_t>("ushort", "int16", is_big, end), "a.ply");
      expect_tetrahedron(binary_ply<uint32_t, uint32_t>("uint", "UINT", is_big, end), "a.ply");
      expect_tetrahedron(binary_ply<int64_t, uint64_t>("int64", "uint64", is_big, end), "a.ply");
      expect_tetrahedron(binary_ply<float, int8_t>("float", "int8", is_big, end), "a.ply");
      expect_tetrahedron(binary_ply<double, int32_t>("Float64", "int", is_big, end), "a.ply");
    }
}

TEST(MeshReaders, PlyStripsAreTriangles) {
  const std::string head = k_ply_text.substr(0, k_ply_text.find("element face"));
  const std::string vertices = "end_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
  // 0 2 1, 1 2 3, 1 3 0 and, begun anew, 0 3 2.
  for (const char* type : {"int", "uint"}) {
    const std::string again = *type == 'i' ? "-1" : "4294967295";
    expect_tetrahedron(head + "element tristrips 1\nproperty list int " + type + " vertex_indices\n" + vertices + "9 0 2 1 3 0 " + again +
                           " 0 3 2\n",
                       "a.ply");
  }
  expect_tetrahedron(
      head + "element tristrips 1\nproperty list int int vertex_indices\nelement face 1\nproperty list uchar int vertex_index\n" +
          vertices + "5 0 2 1 3 0\n3 0 3 2\n",
      "a.ply");
}

TEST(MeshReaders, PlySkipsWhatNobodyNeeds) {
  std::string text = replaced(k_ply_text, "property float x\n", "property float nx\nproperty float x\n");
  for (const char* v : {"0 0 0\n", "1 0 0\n", "0 1 0\n", "0 0 1\n"})
    text = replaced(text, std::string("\n") + v, std::string("\n-1.#IND00 ") + v);
  expect_tetrahedron(text, "a.ply");
  EXPECT_EQ(error_of(replaced(k_ply_text, "\n1 0 0\n", "\n1 nan 0\n"), "a.ply"),
            "a.ply:11: a face uses this vertex, but it is at (1, nan, 0): not finite, or beyond 1e+30");
  EXPECT_EQ(error_of(replaced(k_ply_text, "property float x", "property list uchar float x"), "a.ply"),
            "a.ply: the PLY file has no vertices with x, y and z");
}

TEST(MeshReaders, ACoordinateThatIsNeededMustBeANumber) {
  for (const auto& [word, shown] :
       {std::pair{"nan", "nan"}, {"-inf", "-inf"}, {"-1.#IND00", "nan"}, {"1.#INF", "inf"}, {"1e999", "inf"}, {"-1e31", "-1e+31"}}) {
    const std::string end = std::string(shown) + ", 0): not finite, or beyond 1e+30";
    EXPECT_EQ(error_of(replaced(k_obj_text, "v 1 0 0", std::string("v 1 ") + word + " 0"), "a.obj"),
              "a.obj:2:5: a face uses this vertex, but it is at (1, " + end);
    EXPECT_EQ(error_of(replaced(k_off_text, "\n1 0 0", std::string("\n1 ") + word + " 0"), "a.off"),
              "a.off:4:3: a face uses this vertex, but it is at (1, " + end);
    EXPECT_EQ(error_of(replaced(k_stl_text, "vertex 1 0 0", std::string("vertex 1 ") + word + " 0"), "a.stl"),
              "a.stl:6:10: a face uses this vertex, but it is at (1, " + end);
  }
  EXPECT_EQ(error_of(replaced(k_obj_text, "v 1 0 0", "v 1 1.#OOPS 0"), "a.obj"), "a.obj:2:5: expected three numbers after \"v\"");
}

struct Case {
  const char* file;
  size_t triangles;
  double volume;
};

TEST(MeshReaders, FilesThatOthersWrote) {
  for (const Case& c :
       {Case{"upper.stl", 80, 4.756325655891184}, Case{"end_solid.stl", 80, 4.756325655891184}, Case{"modelnet.off", 80, 4.756325655891184},
        Case{"comment_bs_silent.obj", 1024, 2.3412694285774696}, Case{"underflow.obj", 80, 4.344201188335764}}) {
    Diagnostics diagnostics;
    const Mesh mesh = load_mesh(std::string(KELPIE_CASES "/") + c.file, diagnostics);
    EXPECT_EQ(mesh.triangles.size(), c.triangles) << c.file;
    EXPECT_TRUE(is_closed(mesh)) << c.file;
    EXPECT_NEAR(signed_volume(mesh), c.volume, 1e-9) << c.file;
    EXPECT_TRUE(diagnostics.warnings().empty()) << c.file;
  }
}

} // namespace
} // namespace kelpie
