# SPDX-License-Identifier: GPL-3.0-or-later
# OpenGL is opened at run time: only its headers are needed here. Shaders are built in, so that
# the program works alone.
pkg_check_modules(LIBDEFLATE REQUIRED IMPORTED_TARGET libdeflate)
find_package(glm REQUIRED)
find_package(OpenEXR REQUIRED)
find_path(STB_INCLUDE stb_image.h PATH_SUFFIXES stb REQUIRED)
find_path(GL_INCLUDE GL/glcorearb.h REQUIRED)
find_path(EGL_INCLUDE EGL/egl.h REQUIRED)

file(GLOB shaders CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/shaders/*.glsl
     ${CMAKE_SOURCE_DIR}/shaders/*.vert ${CMAKE_SOURCE_DIR}/shaders/*.frag)
set(embedded ${CMAKE_BINARY_DIR}/embedded_shaders.cpp)
add_custom_command(
    OUTPUT ${embedded}
    COMMAND ${CMAKE_COMMAND} -DFOLDER=${CMAKE_SOURCE_DIR}/shaders -DOUT=${embedded}
            -P ${CMAKE_SOURCE_DIR}/src/render/embed_shaders.cmake
    DEPENDS ${shaders} ${CMAKE_SOURCE_DIR}/src/render/embed_shaders.cmake
    COMMENT "Embedding shaders")

set(font ${CMAKE_SOURCE_DIR}/assets/fonts/DejaVuSans-ASCII.ttf)
set(embedded_font ${CMAKE_BINARY_DIR}/embedded_font.cpp)
add_custom_command(
    OUTPUT ${embedded_font}
    COMMAND ${CMAKE_COMMAND} -DFONT=${font} -DOUT=${embedded_font}
            -P ${CMAKE_SOURCE_DIR}/src/render/embed_font.cmake
    DEPENDS ${font} ${CMAKE_SOURCE_DIR}/src/render/embed_font.cmake
    COMMENT "Embedding the font")

target_sources(swage_render PRIVATE ${embedded} ${embedded_font})
target_include_directories(swage_render SYSTEM PRIVATE ${STB_INCLUDE})
target_link_libraries(swage_render PUBLIC glm::glm PRIVATE PkgConfig::LIBDEFLATE OpenEXR::OpenEXR ${CMAKE_DL_LIBS})
