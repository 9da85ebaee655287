// A picture against its reference, as text: one character for two pixels, from dark to bright. A reference
// that changes for a reason is written anew with KELPIE_UPDATE_REFERENCES=1 and read in the commit's diff.
#include <cmath>

#include "renderer/output/exr.h"
#include "tests/support/program.h"

namespace kelpie {
namespace {

constexpr std::string_view k_ramp = " .,:;=+xoX%#@"; // from dark to bright
/// Of all characters this share may be off by one step: noise of the light's samples at a step's border.
constexpr double k_noisy = 0.02;

class Golden : public ProgramTest {};

/// Pairs of rows as rows of characters: perceived lightness in as many steps as the ramp has.
std::string as_text(const FrameImage& image) {
  std::string text;
  const auto luminance = [&](int x, int y) {
    const size_t i = image.index(x, y);
    return 0.272 * image.find("R")->pixels[i] + 0.674 * image.find("G")->pixels[i] + 0.054 * image.find("B")->pixels[i];
  };
  for (int y = 0; y + 1 < image.resolution.y; y += 2) {
    for (int x = 0; x < image.resolution.x; ++x) {
      const double lightness = std::cbrt(std::clamp(0.5 * (luminance(x, y) + luminance(x, y + 1)), 0.0, 1.0));
      text += k_ramp[std::min(k_ramp.size() - 1, size_t(lightness * double(k_ramp.size())))];
    }
    text += '\n';
  }
  return text;
}

/// How many steps apart two characters are; much for anything that is not in the ramp.
int steps_between(char a, char b) {
  const size_t i = k_ramp.find(a), j = k_ramp.find(b);
  return a == b ? 0 : i == k_ramp.npos || j == k_ramp.npos ? 99 : std::abs(int(i) - int(j));
}

struct Difference {
  int slight = 0, grave = 0; ///< one step apart; more
  std::string map;           ///< blank where equal, else the number of steps
};

Difference difference(const std::string& picture, const std::string& reference) {
  Difference d;
  d.map = picture;
  if (picture.size() != reference.size()) {
    d.grave = int(picture.size());
    return d;
  }
  for (size_t i = 0; i < picture.size(); ++i) {
    const int steps = steps_between(picture[i], reference[i]);
    d.slight += steps == 1, d.grave += steps > 1;
    if (picture[i] != '\n') d.map[i] = steps == 0 ? ' ' : char('0' + std::min(steps, 9));
  }
  return d;
}

void save(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

/// On failure the picture, its reference and their difference are left in golden-failures/.
void expect_like_reference(const std::string& picture, const std::string& name) {
  const std::filesystem::path reference_path = std::filesystem::path(KELPIE_SOURCE) / "tests/references" / (name + ".txt");
  if (std::getenv("KELPIE_UPDATE_REFERENCES")) save(reference_path, picture);
  const std::string reference = text_of(reference_path);
  const Difference d = difference(picture, reference);
  if (d.grave == 0 && d.slight <= k_noisy * double(picture.size())) return;
  const std::filesystem::path folder = std::filesystem::current_path() / "golden-failures";
  save(folder / (name + ".picture.txt"), picture);
  save(folder / (name + ".reference.txt"), reference);
  save(folder / (name + ".difference.txt"), d.map);
  ADD_FAILURE() << name << ": " << d.slight << " characters off by one step, " << d.grave << " by more; see " << folder << '\n' << picture;
}

TEST_F(Golden, Everything) {
  const std::string scene = "'" KELPIE_SOURCE "/tests/references/everything.json'";
  for (const std::string frame : {"1", "3"}) {
    const Outcome o = kelpie("render " + scene + " -f " + frame + " -o a.exr --progress=none");
    ASSERT_EQ(o.status, 0) << o.err;
    expect_like_reference(as_text(read_exr(path("a.exr")).image), "everything." + frame);
  }
}

} // namespace
} // namespace kelpie
