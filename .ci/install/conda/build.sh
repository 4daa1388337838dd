#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# conda-build calls this in a copy of the tree; it sets PREFIX, PYTHON, CPU_COUNT and CMAKE_ARGS.
set -ex
sed -i "1s|^#!/usr/bin/python3|#!$PYTHON|" postprocessing/bin/haff # Debian's Python does not see the packages of conda
sed -i "s|/usr/bin/python3|$PYTHON|" .ci/install/install.cmake
cmake $CMAKE_ARGS -S . -B build -DBUILD_TESTING=OFF -DCMAKE_INSTALL_PREFIX="$PREFIX" -DCMAKE_PREFIX_PATH="$PREFIX"
cmake --build build --parallel "$CPU_COUNT"
cmake --install build
