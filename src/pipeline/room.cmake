find_package(nlohmann_json REQUIRED)
target_link_libraries(swage_pipeline PUBLIC nlohmann_json::nlohmann_json)
target_compile_definitions(swage_pipeline PUBLIC SWAGE_VERSION="${PROJECT_VERSION}")
