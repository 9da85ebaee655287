// make_knot_cloud COUNT OUT.ply: writes the benchmarks' cloud and prints how many blobs overlap at a point.
#include <cstdio>
#include <cstdlib>

#include "bench/knot_cloud.h"
#include "field/clouds/cloud_file.h"

int main(int argc, char** argv) {
  const int count = argc == 3 ? std::atoi(argv[1]) : 0;
  if (count < 1) {
    std::fprintf(stderr, "usage: make_knot_cloud COUNT OUT.ply\n");
    return 2;
  }
  const kelpie::BlobCloud cloud = kelpie::make_knot_cloud(count);
  kelpie::write_blob_cloud(argv[2], cloud);
  std::printf("%.1f\n", kelpie::mean_overlap(cloud));
  return 0;
}
