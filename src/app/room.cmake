find_package(CLI11 REQUIRED)
target_link_libraries(swage PRIVATE CLI11::CLI11)
