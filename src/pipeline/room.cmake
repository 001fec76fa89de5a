find_package(nlohmann_json REQUIRED)
target_link_libraries(swage_pipeline PUBLIC nlohmann_json::nlohmann_json)
target_compile_definitions(swage_pipeline PUBLIC SWAGE_VERSION="${PROJECT_VERSION}")

# The name of the build: one small file, made anew when a source changes. A library of its own, for
# what is made waits for all that its library links.
file(GLOB_RECURSE named CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/src/*.cpp ${CMAKE_SOURCE_DIR}/src/*.h
     ${CMAKE_SOURCE_DIR}/src/*.cmake ${CMAKE_SOURCE_DIR}/shaders/*)
list(FILTER named EXCLUDE REGEX "/src/(app|verify)/")
set(build_name ${CMAKE_BINARY_DIR}/build_name.cpp)
string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type)
set(compiled_by "${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}")
string(APPEND compiled_by " ${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${build_type}}")
add_custom_command(
    OUTPUT ${build_name}
    COMMAND ${CMAKE_COMMAND} -DFOLDER=${CMAKE_SOURCE_DIR} -DOUT=${build_name}
            "-DWITH=${compiled_by}" -P ${CMAKE_SOURCE_DIR}/src/pipeline/build_name.cmake
    DEPENDS ${named} ${CMAKE_SOURCE_DIR}/CMakeLists.txt
    COMMENT "Naming the build"
    VERBATIM)
add_library(swage_build_name STATIC ${build_name})
target_include_directories(swage_build_name PRIVATE ${CMAKE_SOURCE_DIR}/src)
target_link_libraries(swage_pipeline PUBLIC swage_build_name)
