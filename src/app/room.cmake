find_package(CLI11 REQUIRED)
target_link_libraries(swage PRIVATE CLI11::CLI11)
# CLI11 is more to compile than all that stands here: once is enough.
set_target_properties(swage PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0)
