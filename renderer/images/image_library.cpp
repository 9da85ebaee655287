#include "renderer/images/image_library.h"

#include "base/error.h"

#if !defined(KELPIE_STATIC_IMAGES)
#include <filesystem>
#include <new>
#include <string_view>

#include <dlfcn.h>
#include <sys/mman.h>

#include <fmt/format.h>
#endif

namespace kelpie {

namespace {

[[noreturn]] void fail_to_load(const std::string& why) { throw Error(ExitStatus::internal, why); }

#if defined(KELPIE_STATIC_IMAGES)

const ImageLibrary& load_image_library() { return *kelpie_image_library(KELPIE_VERSION); }

#else

namespace fs = std::filesystem;

constexpr const char* k_module = "kelpie_images.so";

/// Beside the program, in the folder where it is built, or where it is installed.
fs::path path_of_module() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const char* folder : {"", "lib/kelpie", "../lib/kelpie"})
    if (const fs::path path = (program / folder / k_module).lexically_normal(); fs::exists(path, error)) return path;
  fail_to_load(fmt::format("{} is missing, which reads and writes pictures: it belongs beside kelpie, or into {}", k_module,
                           (program / "../lib/kelpie").lexically_normal().string()));
}

/// What loading takes, and some more. Where there is less, constructors of libraries fail, each in its own way: some hang.
constexpr size_t k_address_space = size_t(448) << 20;

void require_address_space() {
  void* const reserved = mmap(nullptr, k_address_space, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (reserved == MAP_FAILED) throw std::bad_alloc();
  munmap(reserved, k_address_space);
}

/// The dynamic linker says in words that there is no memory.
bool is_lack_of_memory_of_linker(std::string_view why) {
  for (const std::string_view lack : {"annot allocate memory", "failed to map segment", "annot map zero-fill pages", "annot create"})
    if (why.find(lack) != why.npos) return true;
  return false;
}

/// What a constructor of a library throws must not come through the dynamic linker: it ends the program, as it does before main().
void* load(const fs::path& module) noexcept { return dlopen(module.c_str(), RTLD_LAZY | RTLD_LOCAL); }

/// It stays loaded: threads of its libraries may run until the process ends.
const ImageLibrary& load_image_library() {
  const fs::path path = path_of_module();
  require_address_space();
  void* const module = load(path);
  if (!module) {
    const std::string why = dlerror();
    if (is_lack_of_memory_of_linker(why)) throw std::bad_alloc();
    fail_to_load(fmt::format("cannot load {}: {}", path.string(), why));
  }
  const auto function = reinterpret_cast<decltype(&kelpie_image_library)>(dlsym(module, "kelpie_image_library"));
  const ImageLibrary* library = function ? function(KELPIE_VERSION) : nullptr;
  if (!library) fail_to_load(fmt::format("{} is not of this version of kelpie, {}", path.string(), KELPIE_VERSION));
  return *library;
}

#endif

} // namespace

const ImageLibrary& image_library() {
  static const ImageLibrary& library = load_image_library();
  return library;
}

} // namespace kelpie
