#include "renderer/output/png.h"

#include <bit>
#include <csetjmp>
#include <new>
#include <string>

#include <png.h>

#include "base/error.h"

namespace kelpie {

namespace {

/// What libpng's callbacks see. It is C: they leave it by a jump, past nothing that has a destructor.
struct Writing {
  std::vector<unsigned char> bytes;
  bool has_no_memory = false;
  char problem[128] = "";
};

void append(png_structp png, png_bytep data, size_t size) {
  auto& to = *static_cast<Writing*>(png_get_io_ptr(png));
  try {
    to.bytes.insert(to.bytes.end(), data, data + size);
    return;
  } catch (const std::bad_alloc&) {
    to.has_no_memory = true;
  }
  png_error(png, "no memory");
}

void keep_problem(png_structp png, png_const_charp text) {
  auto& to = *static_cast<Writing*>(png_get_error_ptr(png));
  to.problem[std::string_view(text).copy(to.problem, sizeof(to.problem) - 1)] = 0;
  png_longjmp(png, 1);
}

/// False where libpng gave up; `to` says why.
bool write(Writing& to, png_structp png, png_infop info, int width, int height, int bits, bool is_srgb, const unsigned char* pixels) {
  if (setjmp(png_jmpbuf(png))) return false;
  png_set_write_fn(png, &to, append, nullptr);
  png_set_IHDR(png, info, png_uint_32(width), png_uint_32(height), bits, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  if (is_srgb) png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_write_info(png, info);
  if (bits == 16 && std::endian::native == std::endian::little) png_set_swap(png);
  const size_t stride = size_t(width) * 3 * size_t(bits / 8);
  for (int y = 0; y < height; ++y) png_write_row(png, pixels + size_t(y) * stride);
  png_write_end(png, info);
  return true;
}

} // namespace

std::vector<unsigned char> png_file(int width, int height, int bits, bool is_srgb, const void* pixels) {
  Writing to;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &to, keep_problem, [](png_structp, png_const_charp) {});
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  const bool is_written = info && write(to, png, info, width, height, bits, is_srgb, static_cast<const unsigned char*>(pixels));
  png_destroy_write_struct(&png, &info);
  if (!is_written && (to.has_no_memory || to.problem[0] == 0)) throw std::bad_alloc();
  if (!is_written) throw Error(ExitStatus::internal, "the PNG encoder failed: " + std::string(to.problem));
  return std::move(to.bytes);
}

} // namespace kelpie
