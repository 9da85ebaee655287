find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)
find_package(glm REQUIRED)
find_package(fmt REQUIRED)
find_package(TBB REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(embree 3.13 REQUIRED)
find_package(OpenImageIO REQUIRED)
# Debian's target names OpenCV's folder, which only OpenCV's own development package would bring.
set_target_properties(OpenImageIO::OpenImageIO PROPERTIES
  INTERFACE_INCLUDE_DIRECTORIES "" INTERFACE_SYSTEM_INCLUDE_DIRECTORIES "")
find_package(OpenEXR REQUIRED)
find_package(Ceres REQUIRED)
find_package(Eigen3 REQUIRED)
find_package(hwy REQUIRED)
find_package(muparser REQUIRED)
find_package(OpenMesh REQUIRED)
find_package(TinyGLTF REQUIRED)
# Debian's OpenColorIO config file sets a wrong prefix; its pkg-config file is right.
pkg_check_modules(OCIO REQUIRED IMPORTED_TARGET OpenColorIO)
# libzip's config file asks for its command-line tools.
pkg_check_modules(LIBZIP REQUIRED IMPORTED_TARGET libzip)
pkg_check_modules(DEFLATE REQUIRED IMPORTED_TARGET libdeflate)
pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)
# OpenSubdiv's config file asks for a static library that Debian does not have.
find_library(OSD_CPU osdCPU REQUIRED)
find_library(QHULL_R qhull_r REQUIRED)
