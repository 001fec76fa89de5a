// SPDX-License-Identifier: GPL-3.0-or-later
// Only for Catch2 version 2, which has no library with a main.
#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>
