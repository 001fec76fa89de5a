# CGAL (geometry/room.cmake) triangulates the section that a blade leaves.
set_source_files_properties(${CMAKE_SOURCE_DIR}/src/skin/section.cpp
                            PROPERTIES COMPILE_OPTIONS -frounding-math
                                       SKIP_PRECOMPILE_HEADERS ON)
target_link_libraries(swage_skin PRIVATE ${GMP} ${MPFR})
