# assimp by pkg-config: Debian's CMake file for it asks for development files of draco.
pkg_check_modules(ASSIMP REQUIRED IMPORTED_TARGET assimp)
# CGAL is headers, GMP and MPFR. Its exact arithmetic wants -frounding-math, which its CMake target
# would force on the whole room.
find_path(CGAL_HEADERS CGAL/version.h REQUIRED)
find_library(GMP gmp REQUIRED)
find_library(MPFR mpfr REQUIRED)
set_source_files_properties(${CMAKE_SOURCE_DIR}/src/geometry/mesh_repair_cgal.cpp
                            PROPERTIES COMPILE_OPTIONS -frounding-math
                                       SKIP_PRECOMPILE_HEADERS ON)
pkg_check_modules(LIBZIP REQUIRED IMPORTED_TARGET libzip)
pkg_check_modules(PUGIXML REQUIRED IMPORTED_TARGET pugixml)
find_package(nlohmann_json REQUIRED)
target_link_libraries(swage_geometry PRIVATE PkgConfig::ASSIMP ${GMP} ${MPFR}
                                             nlohmann_json::nlohmann_json PkgConfig::LIBZIP
                                             PkgConfig::PUGIXML)
