# Run by CPack in the folder that becomes the package: what Debian's policy asks for beside the installed files.
set(STAGE ${CPACK_TEMPORARY_DIRECTORY}/usr)
set(DOC ${STAGE}/share/doc/pellicle)
get_filename_component(SOURCE ${CMAKE_CURRENT_LIST_DIR}/.. ABSOLUTE)
configure_file(${SOURCE}/CHANGELOG.md ${DOC}/NEWS.md COPYONLY)
string(TIMESTAMP NOW "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(WRITE ${DOC}/changelog "pellicle (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium

  * Release ${CPACK_PACKAGE_VERSION}; NEWS.md.gz says what changed.

 -- ${CPACK_PACKAGE_CONTACT}  ${NOW}
")
file(READ ${SOURCE}/LICENSE LICENSE)
file(WRITE ${DOC}/copyright "Pellicle is distributed under the MIT license.\n\n${LICENSE}")
file(REMOVE ${DOC}/LICENSE)
foreach(FILE ${DOC}/changelog ${DOC}/NEWS.md ${STAGE}/share/man/man1/pellicle.1)
    execute_process(COMMAND gzip -9nf ${FILE} COMMAND_ERROR_IS_FATAL ANY)
endforeach()
