// sequence_coverage [--above HEIGHT] FRAMES...: how much of each frame a sequence covers (the mean of alpha), and
// the largest difference of neighbouring frames as a share of the largest coverage. A shape that pops, or is
// lost for a frame, shows here. Where a floor fills the picture, --above counts the pixels whose surface lies
// higher than HEIGHT (the channel P.Y). Exit status: 0 if the largest difference is at most 5 %, 1 if not.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string_view>
#include <vector>

#include <OpenImageIO/imageio.h>

namespace {

constexpr double k_largest_step = 0.05;

/// One channel of a file; empty if there is none.
std::vector<float> read_channel(const char* path, const char* name) {
  const auto input = OIIO::ImageInput::open(path);
  if (!input) return {};
  const auto& names = input->spec().channelnames;
  const auto at = static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin());
  std::vector<float> values(input->spec().image_pixels());
  if (at == static_cast<int>(names.size()) || !input->read_image(0, 0, at, at + 1, OIIO::TypeDesc::FLOAT, values.data())) return {};
  return values;
}

/// The share of the picture that is covered (above `height`, if that is finite); below 0 if the file cannot be read.
double coverage(const char* path, double height) {
  const std::vector<float> alpha = read_channel(path, "A");
  const std::vector<float> y = std::isfinite(height) ? read_channel(path, "P.Y") : std::vector<float>(alpha.size(), 0.f);
  if (alpha.empty() || y.size() != alpha.size()) return -1;
  double sum = 0;
  for (size_t i = 0; i < alpha.size(); ++i)
    if (y[i] > height) sum += alpha[i];
  return sum / static_cast<double>(alpha.size());
}

} // namespace

int main(int argc, char** argv) {
  double height = -std::numeric_limits<double>::infinity();
  int first = 1;
  if (argc > 2 && std::string_view(argv[1]) == "--above") height = std::atof(argv[2]), first = 3;
  if (argc <= first) {
    std::fprintf(stderr, "usage: sequence_coverage [--above HEIGHT] FRAMES...\n");
    return 2;
  }
  std::vector<double> covered;
  for (int i = first; i < argc; ++i) {
    const double c = coverage(argv[i], height);
    if (!(c >= 0)) {
      std::fprintf(stderr, "sequence_coverage: %s: no picture with the channels that this takes\n", argv[i]);
      return 66;
    }
    std::printf("%s %.5f\n", argv[i], c);
    covered.push_back(c);
  }
  if (*std::min_element(covered.begin(), covered.end()) > 0.999) {
    std::fprintf(stderr, "sequence_coverage: every frame is full, so nothing could be seen to pop; leave the floor out by --above\n");
    return 2;
  }
  double step = 0;
  for (size_t i = 1; i < covered.size(); ++i) step = std::max(step, std::abs(covered[i] - covered[i - 1]));
  const double largest = *std::max_element(covered.begin(), covered.end()), share = largest > 0 ? step / largest : 0;
  std::printf("largest coverage %.5f, largest step between neighbours %.2f %% of it\n", largest, 100 * share);
  return share <= k_largest_step ? 0 : 1;
}
