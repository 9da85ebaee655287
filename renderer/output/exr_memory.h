// Memory as OpenEXR's streams.
#pragma once

#include <cstring>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <Iex.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfThreading.h>

namespace kelpie {

/// Appends, or overwrites where it was told to go.
class MemoryOutput : public Imf::OStream {
public:
  explicit MemoryOutput(std::vector<unsigned char>& bytes) : OStream("memory"), bytes_(bytes) {}

  void write(const char c[], int n) override {
    if (bytes_.size() < at_ + size_t(n)) bytes_.resize(at_ + size_t(n));
    std::memcpy(bytes_.data() + at_, c, size_t(n));
    at_ += size_t(n);
  }
  uint64_t tellp() override { return at_; }
  void seekp(uint64_t at) override { at_ = at; }

private:
  std::vector<unsigned char>& bytes_;
  size_t at_ = 0;
};

class MemoryInput : public Imf::IStream {
public:
  MemoryInput(std::span<const unsigned char> bytes, const std::string& name) : IStream(name.c_str()), bytes_(bytes) {}

  bool read(char c[], int n) override {
    if (n < 0 || at_ > bytes_.size() || bytes_.size() - at_ < size_t(n)) throw Iex::InputExc("truncated");
    std::memcpy(c, bytes_.data() + at_, size_t(n));
    at_ += size_t(n);
    return at_ < bytes_.size();
  }
  uint64_t tellg() override { return at_; }
  void seekg(uint64_t at) override { at_ = at; }

private:
  std::span<const unsigned char> bytes_;
  size_t at_ = 0;
};

/// How many threads a file may use. The first call makes them, and sets how large a picture OpenEXR reads: 65,536 pixels a side.
inline int use_exr_threads() {
  static const int count = [] {
    constexpr int k_max_side = 65536;
    Imf::Header::setMaxImageSize(k_max_side, k_max_side);
    Imf::setGlobalThreadCount(static_cast<int>(std::thread::hardware_concurrency()));
    return Imf::globalThreadCount();
  }();
  return count;
}

} // namespace kelpie
