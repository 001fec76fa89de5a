# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DFONT=font.ttf -DOUT=embedded.cpp -P embed_font.cmake: its bytes as an array.
file(READ ${FONT} bytes HEX)
string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
file(WRITE ${OUT} "// Made by embed_font.cmake.
#include \"render/letters.h\"

namespace swage {

std::span<const unsigned char> embedded_font() {
    static const unsigned char bytes[] = {${bytes}};
    return bytes;
}

}  // namespace swage
")
