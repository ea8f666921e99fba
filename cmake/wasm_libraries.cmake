# libfyaml and zlib for WebAssembly, from the sources that tools/fetch-sources brings
set(SOURCES ${PROJECT_BINARY_DIR}/sources)
if(NOT EXISTS ${SOURCES}/libfyaml OR NOT EXISTS ${SOURCES}/zlib)
    message(FATAL_ERROR "the sources of libfyaml and zlib are missing in ${SOURCES}: run tools/fetch-sources ${SOURCES}, or make wasm")
endif()

file(GLOB FYAML_SOURCES ${SOURCES}/libfyaml/src/lib/*.c ${SOURCES}/libfyaml/src/xxhash/*.c)
add_library(fyaml STATIC ${FYAML_SOURCES})
add_library(PkgConfig::FYAML ALIAS fyaml)
target_include_directories(fyaml SYSTEM PUBLIC ${SOURCES}/libfyaml/include
                           PRIVATE ${SOURCES}/libfyaml/src/lib ${SOURCES}/libfyaml/src/xxhash)
target_compile_definitions(fyaml PRIVATE _GNU_SOURCE VERSION="Debian")
target_compile_options(fyaml PRIVATE -w)
set_target_properties(fyaml PROPERTIES C_EXTENSIONS ON)

set(ZLIB_SOURCES)
foreach(name adler32 crc32 deflate inffast inflate inftrees trees zutil)
    list(APPEND ZLIB_SOURCES ${SOURCES}/zlib/${name}.c)
endforeach()
add_library(zlib STATIC ${ZLIB_SOURCES})
add_library(ZLIB::ZLIB ALIAS zlib)
target_include_directories(zlib SYSTEM PUBLIC ${SOURCES}/zlib)
target_compile_options(zlib PRIVATE -w)
