# SPDX-License-Identifier: GPL-3.0-or-later
# cmake -DSOURCE=.. -DHEADER=.. -P gitVersion.cmake: writes the commit of the tree, with -dirty where it was edited, to a header.
# Each build runs this first. The header is touched only if it changes, so that nothing is built for the same commit.
execute_process(COMMAND git describe --always --dirty --tags WORKING_DIRECTORY ${SOURCE}
                OUTPUT_VARIABLE version OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE bad)
if(bad OR NOT version)
  set(version unknown) # a tree without git
endif()
file(CONFIGURE OUTPUT ${HEADER} CONTENT "#define HAFF_GIT \"${version}\"\n")
