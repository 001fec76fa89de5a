# assimp by pkg-config: Debian's CMake file for it asks for development files of draco.
pkg_check_modules(ASSIMP REQUIRED IMPORTED_TARGET assimp)
find_package(CGAL REQUIRED)  # headers only, with GMP and MPFR
target_link_libraries(swage_geometry PRIVATE PkgConfig::ASSIMP CGAL::CGAL)
