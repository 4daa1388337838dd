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
  # Libraries of the system are found without a path.
  file(GLOB_RECURSE binaries ${root}/bin/* ${root}/lib/haff/*.so)
  foreach(binary ${binaries})
    file(RPATH_REMOVE FILE ${binary})
  endforeach()
endforeach()
