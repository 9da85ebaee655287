// make_creature_tree [--twist] OUT.json: writes the benchmarks' creature as a scene file.
#include <cstdio>
#include <fstream>
#include <string_view>

#include "bench/creature_tree.h"

int main(int argc, char** argv) {
  const bool is_twisted = argc > 1 && std::string_view(argv[1]) == "--twist";
  if (argc != (is_twisted ? 3 : 2)) {
    std::fprintf(stderr, "usage: make_creature_tree [--twist] OUT.json\n");
    return 2;
  }
  std::ofstream out(argv[argc - 1]);
  out << kelpie::make_creature_scene(is_twisted ? kelpie::CreatureWarps::twist : kelpie::CreatureWarps::none) << std::flush;
  if (!out) std::fprintf(stderr, "make_creature_tree: %s: could not be written\n", argv[argc - 1]);
  return out ? 0 : 74;
}
