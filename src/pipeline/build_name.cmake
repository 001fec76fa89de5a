# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DFOLDER=... -DWITH=what compiles -DOUT=build_name.cpp -P build_name.cmake: a hash of the
# sources that make a run's results, which are all but those of the front door and of `verify`. No
# commit: this changes with what is not committed, and not with what no run is made by.
file(GLOB_RECURSE sources RELATIVE ${FOLDER} ${FOLDER}/src/*.cpp ${FOLDER}/src/*.h
     ${FOLDER}/src/*.cmake ${FOLDER}/shaders/*)
list(FILTER sources EXCLUDE REGEX "^src/(app|verify)/")
list(SORT sources)
set(all "${WITH}")
foreach(source CMakeLists.txt ${sources})
    file(SHA256 ${FOLDER}/${source} hash)
    string(APPEND all " ${source} ${hash}")
endforeach()
string(SHA256 name "${all}")
string(SUBSTRING ${name} 0 12 name)
set(text "// Made by build_name.cmake.\n#include \"pipeline/build_name.h\"\n\n")
string(APPEND text "namespace swage {\n\n")
string(APPEND text "const char* const kBuildName = \"${name}\";\n\n}  // namespace swage\n")
file(WRITE ${OUT} "${text}")
