# Skin: CGAL triangulates the section that a blade leaves (headers only, with GMP and MPFR).
find_package(CGAL REQUIRED)
target_link_libraries(swage_skin PRIVATE CGAL::CGAL)
