# law/files.h includes the file of each row of PEL_MEMBRANE_LAWS, so that a law is a row and a file.
set(LAWS ${PROJECT_SOURCE_DIR}/include/pellicle/kinds.h)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${LAWS})
file(READ ${LAWS} text)
string(REGEX MATCHALL " ROW\\([A-Z_0-9]+, [a-z_0-9]+" rows "${text}")
list(TRANSFORM rows REPLACE ".*, (.*)" "#include \"law/\\1.h\"\n")
list(JOIN rows "" includes)
file(CONFIGURE OUTPUT generated/law/files.h CONTENT "/* Made by cmake/laws.cmake. */\n${includes}")
target_include_directories(pellicle_flags INTERFACE ${PROJECT_BINARY_DIR}/generated)
