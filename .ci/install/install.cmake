# SPDX-License-Identifier: GPL-3.0-or-later
# What  cmake --install build --prefix P  and  cpack  put where. Nothing there needs this tree, and P may be moved. Three
# components, each a package of cpack:
#   programs  (haff)           P/bin: programs and commands; P/lib/haff: what these find by their own place, mpirun, the
#                              Python package and haffgas.so, which it loads; P/share: documents, manual pages, completion for bash
#   implicit  (haff-implicit)  P/lib/haff/haffimplicit.so. A package of its own, so that nobody has to install PETSc's
#                              hundred libraries for runs that do without
#   library   (libhaff-dev)    P/lib/libhaff*.a, P/include/haff, what find_package and pkg-config read
set(here ${CMAKE_CURRENT_LIST_DIR})
set(CMAKE_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
                                                WORLD_EXECUTE)

# Programs. The mpirun that knows how to stop them lies where it hides no other.
install(TARGETS ${PROGRAMS} RUNTIME DESTINATION bin COMPONENT programs)
install(PROGRAMS postprocessing/bin/haff DESTINATION bin COMPONENT programs)
foreach(command ${COMMANDS})
  install(CODE "file(CREATE_LINK haff \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/bin/${command}\" SYMBOLIC)" COMPONENT programs)
endforeach()
install(PROGRAMS solvers/programs/mpirun DESTINATION lib/haff COMPONENT programs)
if(TARGET haffgas)
  install(TARGETS haffgas LIBRARY DESTINATION lib/haff COMPONENT programs)
endif()
install(DIRECTORY postprocessing/haff DESTINATION lib/haff/python COMPONENT programs
        FILES_MATCHING PATTERN "*.py" PATTERN "*.css" PATTERN "*.js" PATTERN "*.LICENSE.txt" PATTERN __pycache__ EXCLUDE)
if(TARGET haffimplicit)
  install(TARGETS haffimplicit LIBRARY DESTINATION lib/haff COMPONENT implicit)
endif()

# Documents, as they lie here, so that their links to each other hold.
install(FILES README.md CHANGELOG.md LICENSE DESTINATION share/doc/haff COMPONENT programs)
install(DIRECTORY docs DESTINATION share/doc/haff COMPONENT programs
        FILES_MATCHING PATTERN "*.md" PATTERN "*.ipynb" PATTERN "*.jpg" PATTERN "sod.c" PATTERN CMakeLists.txt PATTERN examples EXCLUDE)

# Manual pages are made from what the installed programs say to -help.
if(NOT CMAKE_CROSSCOMPILING)
  install(CODE "execute_process(COMMAND /usr/bin/python3 -B ${here}/manPages \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}\" RESULT_VARIABLE bad)
    if(bad)
      message(WARNING \"some manual pages could not be made, see above\")
    endif()" COMPONENT programs)
  # So are keywords for editors.
  install(CODE "set(prefix \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}\")
    execute_process(COMMAND \${CMAKE_COMMAND} -E env HAFF_BIN=\${prefix}/bin /usr/bin/python3 -B ${CMAKE_SOURCE_DIR}/docs/makeEditors \${prefix}/share/haff/editors
                    RESULT_VARIABLE bad)
    if(bad)
      message(WARNING \"the keywords for editors could not be written, see above\")
    endif()" COMPONENT programs)
endif()
# Completion for bash; its loader looks for a file of the command's name.
list(JOIN PROGRAMS " " programs)
list(JOIN COMMANDS " " commands)
configure_file(.ci/install/completion install/completion @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/install/completion RENAME haff DESTINATION share/bash-completion/completions COMPONENT programs)
foreach(command ${PROGRAMS} ${COMMANDS})
  install(CODE "file(CREATE_LINK haff \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/share/bash-completion/completions/${command}\" SYMBOLIC)"
          COMPONENT programs)
endforeach()

# The library. Public are the rooms that the programs of solvers/ are themselves written with: space (mesh), physics (libcore
# without its two engines, which gas.h hides), and of solvers what reads cases, runs them and loads the module; not
# what hides itself by its name.
file(GLOB_RECURSE headers RELATIVE ${CMAKE_SOURCE_DIR} CONFIGURE_DEPENDS mesh/*.h libcore/*.h solvers/dict/*.h solvers/case/*.h)
list(FILTER headers EXCLUDE REGEX "_(private|parts|reading)\\.h$|^libcore/(lattice|polyhedral)/|/(engine|patch)\\.h$")
list(APPEND headers solvers/programs/run.h solvers/gas/linear.h)
foreach(header ${headers})
  get_filename_component(room ${header} DIRECTORY)
  install(FILES ${header} DESTINATION include/haff/${room} COMPONENT library)
endforeach()
foreach(layer mesh core case)
  set_target_properties(haff${layer} PROPERTIES EXPORT_NAME ${layer})
endforeach()
add_library(haff INTERFACE) # all three
target_link_libraries(haff INTERFACE haffcase)
install(TARGETS haff haffcase haffcore haffmesh EXPORT haffTargets ARCHIVE DESTINATION lib COMPONENT library)
install(EXPORT haffTargets NAMESPACE haff:: DESTINATION lib/cmake/haff COMPONENT library)
include(CMakePackageConfigHelpers)
configure_package_config_file(.ci/install/haffConfig.cmake.in install/haffConfig.cmake INSTALL_DESTINATION lib/cmake/haff)
write_basic_package_version_file(${CMAKE_BINARY_DIR}/install/haffConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/install/haffConfig.cmake ${CMAKE_BINARY_DIR}/install/haffConfigVersion.cmake
        DESTINATION lib/cmake/haff COMPONENT library)
set(pc_libs "")
foreach(path ${p4est_LIBRARY} ${sc_LIBRARY} ${metis_LIBRARY} ${lapacke_LIBRARY} ${deflate_LIBRARY} ${ZLIB_LIBRARIES} ${MPI_C_LIBRARIES})
  get_filename_component(folder ${path} DIRECTORY)
  get_filename_component(name ${path} NAME_WE)
  string(REGEX REPLACE "^lib" "-l" name ${name})
  if(NOT folder IN_LIST CMAKE_C_IMPLICIT_LINK_DIRECTORIES)
    string(APPEND pc_libs " -L${folder}")
  endif()
  string(APPEND pc_libs " ${name}")
endforeach()
configure_file(.ci/install/haff.pc.in install/haff.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/install/haff.pc DESTINATION lib/pkgconfig COMPONENT library)

# A wheel for pip, in build/dist.
add_custom_target(wheel COMMAND /usr/bin/python3 -B ${here}/makeWheel ${CMAKE_BINARY_DIR} ${CMAKE_BINARY_DIR}/dist
                  DEPENDS ${PROGRAMS} haffgas VERBATIM)

# An image for podman.
add_custom_target(container COMMAND ${here}/makeContainer VERBATIM)

# A site of the documents, in build/site.
add_custom_target(site COMMAND /usr/bin/python3 -B ${CMAKE_SOURCE_DIR}/docs/makeSite ${CMAKE_BINARY_DIR}/site VERBATIM)

# Packages for Debian:  cd build && cpack. What they need of libraries is found by dpkg-shlibdeps (debian.cmake).
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME haff)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "gas dynamics of granular matter")
set(CPACK_PACKAGE_CONTACT "haff maintainers <haff@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS ${CMAKE_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS})
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL programs library)
if(TARGET haffimplicit)
  list(APPEND CPACK_COMPONENTS_ALL implicit)
endif()
set(CPACK_PRE_BUILD_SCRIPTS ${here}/debian.cmake)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME haff)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_DEPENDS "python3, python3-numpy, python3-matplotlib, openmpi-bin")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_RECOMMENDS "gmsh, python3-scipy, haff-implicit")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SUGGESTS "python3-vtk9, python3-meshio, python3-pandas, paraview, ffmpeg, libhaff-dev")
set(CPACK_COMPONENT_PROGRAMS_DESCRIPTION "Solves the equations of rapid granular flow, a gas of grains that lose energy
at every collision, on lattices and polyhedral meshes, with MPI; moves the
grains themselves, event by event; draws and compares what comes out.")
set(CPACK_DEBIAN_IMPLICIT_PACKAGE_NAME haff-implicit)
set(CPACK_DEBIAN_IMPLICIT_PACKAGE_DEPENDS "haff (= ${PROJECT_VERSION})")
set(CPACK_COMPONENT_IMPLICIT_DESCRIPTION "The module with PETSc that granularGas loads for implicit diffusion.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libhaff-dev)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "libopenmpi-dev, libp4est-dev, libmetis-dev, liblapacke-dev, libdeflate-dev, zlib1g-dev")
set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "Static libraries and headers of haff, for find_package(haff) and pkg-config.")
include(CPack)
