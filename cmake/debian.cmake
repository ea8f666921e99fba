# Run by CPack with a folder per component, each of which becomes a package: what Debian's policy asks for beside the installed files.
get_filename_component(SOURCE ${CMAKE_CURRENT_LIST_DIR}/.. ABSOLUTE)
string(TIMESTAMP NOW "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(READ ${SOURCE}/LICENSE LICENSE)
foreach(COMPONENT program dev python)
    string(TOUPPER ${COMPONENT} UPPER)
    set(NAME ${CPACK_DEBIAN_${UPPER}_PACKAGE_NAME})
    set(STAGE ${CPACK_TEMPORARY_DIRECTORY}/${COMPONENT}/usr)
    if(NOT EXISTS ${STAGE})
        continue()
    endif()
    set(DOC ${STAGE}/share/doc/${NAME})
    configure_file(${SOURCE}/CHANGELOG.md ${DOC}/NEWS.md COPYONLY)
    file(WRITE ${DOC}/changelog "pellicle (${CPACK_PACKAGE_VERSION}) unstable; urgency=medium

  * Release ${CPACK_PACKAGE_VERSION}; NEWS.md.gz lists the changes.

 -- ${CPACK_PACKAGE_CONTACT}  ${NOW}
")
    file(WRITE ${DOC}/copyright "Pellicle is distributed under the MIT license.\n\n${LICENSE}")
    file(REMOVE ${DOC}/LICENSE)
    set(COMPRESSED ${DOC}/changelog ${DOC}/NEWS.md)
    if(COMPONENT STREQUAL program)
        list(APPEND COMPRESSED ${STAGE}/share/man/man1/pellicle.1)
    endif()
    foreach(FILE ${COMPRESSED})
        execute_process(COMMAND gzip -9nf ${FILE} COMMAND_ERROR_IS_FATAL ANY)
    endforeach()
endforeach()
