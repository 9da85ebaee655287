// Compares the hit masks (alpha) of two pictures of one scene: every pixel that differs must lie on a
// silhouette, where the last bit of a ray decides. Exit status 1 when one does not.
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <OpenImageIO/imageio.h>

namespace {

struct Mask {
  int width = 0, height = 0;
  std::vector<char> hit;
  bool at(int x, int y) const { return hit[size_t(y) * width + x] != 0; }
};

Mask read_mask(const char* path) {
  const auto input = OIIO::ImageInput::open(path);
  Mask mask;
  const int alpha = input ? input->spec().alpha_channel : -1;
  if (alpha < 0) {
    std::fprintf(stderr, "compare_masks: %s: no picture with alpha\n", path);
    std::exit(66);
  }
  mask.width = input->spec().width, mask.height = input->spec().height;
  std::vector<float> values(size_t(mask.width) * mask.height);
  if (!input->read_image(0, 0, alpha, alpha + 1, OIIO::TypeDesc::FLOAT, values.data())) {
    std::fprintf(stderr, "compare_masks: %s: %s\n", path, input->geterror().c_str());
    std::exit(65);
  }
  for (const float v : values) mask.hit.push_back(v > 0.5f);
  return mask;
}

/// Whether a neighbour of the pixel is in the other state.
bool is_silhouette(const Mask& mask, int x, int y) {
  for (int j = y - 1; j <= y + 1; ++j)
    for (int i = x - 1; i <= x + 1; ++i)
      if (i >= 0 && j >= 0 && i < mask.width && j < mask.height && mask.at(i, j) != mask.at(x, y)) return true;
  return false;
}

} // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: compare_masks A B\n");
    return 2;
  }
  const Mask a = read_mask(argv[1]), b = read_mask(argv[2]);
  if (a.width != b.width || a.height != b.height) {
    std::fprintf(stderr, "compare_masks: sizes differ\n");
    return 65;
  }
  int hits = 0, differ = 0, inside = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      hits += a.at(x, y);
      if (a.at(x, y) == b.at(x, y)) continue;
      ++differ;
      inside += !is_silhouette(a, x, y) && !is_silhouette(b, x, y);
    }
  std::printf("%d hits, %d differ, %d not on a silhouette\n", hits, differ, inside);
  return inside == 0 ? 0 : 1;
}
