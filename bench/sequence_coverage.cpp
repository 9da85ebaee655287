// sequence_coverage FRAMES...: how much of each frame a sequence covers (the mean of alpha), and the largest
// difference of neighbouring frames as a share of the largest coverage. A shape that pops, or is lost for a
// frame, shows here. Exit status: 0 if the largest difference is at most 5 %, 1 if not.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include <OpenImageIO/imageio.h>

namespace {

constexpr double k_largest_step = 0.05;

/// The mean of alpha; below 0 if the file cannot be read.
double coverage(const char* path) {
  const auto input = OIIO::ImageInput::open(path);
  const int alpha = input ? input->spec().alpha_channel : -1;
  if (alpha < 0) return -1;
  std::vector<float> values(input->spec().image_pixels());
  if (!input->read_image(0, 0, alpha, alpha + 1, OIIO::TypeDesc::FLOAT, values.data())) return -1;
  double sum = 0;
  for (const float v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

} // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: sequence_coverage FRAMES...\n");
    return 2;
  }
  std::vector<double> covered;
  for (int i = 1; i < argc; ++i) {
    const double c = coverage(argv[i]);
    if (!(c >= 0)) {
      std::fprintf(stderr, "sequence_coverage: %s: no picture with alpha\n", argv[i]);
      return 66;
    }
    std::printf("%s %.5f\n", argv[i], c);
    covered.push_back(c);
  }
  double step = 0;
  for (size_t i = 1; i < covered.size(); ++i) step = std::max(step, std::abs(covered[i] - covered[i - 1]));
  const double largest = *std::max_element(covered.begin(), covered.end()), share = largest > 0 ? step / largest : 0;
  std::printf("largest coverage %.5f, largest step between neighbours %.2f %% of it\n", largest, 100 * share);
  return share <= k_largest_step ? 0 : 1;
}
