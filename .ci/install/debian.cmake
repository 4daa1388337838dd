# SPDX-License-Identifier: GPL-3.0-or-later
# cpack calls this between installing into its folder and making the packages: what Debian wants of a package besides.
set(package_programs haff)
set(package_implicit haff-implicit)
set(package_library libhaff-dev)
foreach(component ${CPACK_COMPONENTS_ALL})
  set(root ${CPACK_TEMPORARY_DIRECTORY}/${component}/usr)
  set(doc ${root}/share/doc/${package_${component}})
  file(REMOVE ${root}/share/doc/haff/LICENSE) # it is in common-licenses
  file(COPY ${CMAKE_CURRENT_LIST_DIR}/copyright DESTINATION ${doc}
       FILE_PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
  string(TIMESTAMP now "%a, %d %b %Y %H:%M:%S +0000" UTC)
  file(WRITE ${doc}/changelog "haff (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium

  * As /usr/share/doc/haff/CHANGELOG.md says.

 -- ${CPACK_PACKAGE_CONTACT}  ${now}
")
  file(CHMOD ${doc}/changelog FILE_PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
  file(GLOB texts ${doc}/changelog ${root}/share/man/man1/*.1)
  execute_process(COMMAND gzip -9n ${texts} COMMAND_ERROR_IS_FATAL ANY)
  # Libraries of the system are found without a path; their packages are what ours depends on. CPack's own way to these asks two processes
  # about each file.
  file(GLOB_RECURSE files ${root}/bin/* ${root}/lib/haff/*.so)
  set(binaries)
  foreach(file ${files})
    file(READ ${file} magic LIMIT 4 HEX)
    if(magic STREQUAL 7f454c46) # ELF
      file(RPATH_REMOVE FILE ${file})
      list(APPEND binaries ${file})
    endif()
  endforeach()
  if(binaries)
    file(WRITE ${CPACK_TEMPORARY_DIRECTORY}/debian/control "") # without it dpkg-shlibdeps does nothing
    execute_process(COMMAND dpkg-shlibdeps --ignore-missing-info -O ${binaries} WORKING_DIRECTORY ${CPACK_TEMPORARY_DIRECTORY}
                    OUTPUT_VARIABLE found OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET COMMAND_ERROR_IS_FATAL ANY)
    file(REMOVE_RECURSE ${CPACK_TEMPORARY_DIRECTORY}/debian)
    string(REGEX REPLACE "^.*Depends=" ", " found "${found}")
    string(TOUPPER ${component} name)
    string(APPEND CPACK_DEBIAN_${name}_PACKAGE_DEPENDS "${found}")
  endif()
endforeach()
