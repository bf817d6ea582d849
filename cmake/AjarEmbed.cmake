# ajar_embed(TARGET FILE): compiles a text file into a target as ajar::page::kPage. Raw strings are cut into pieces because
# compilers promise no more than 64 KiB of one.
function(ajar_embed target file)
  set(source "${PROJECT_BINARY_DIR}/embedded/page.cpp")
  add_custom_command(OUTPUT "${source}"
    COMMAND "${CMAKE_COMMAND}" -DINPUT=${file} -DOUTPUT=${source} -P "${PROJECT_SOURCE_DIR}/cmake/EmbedText.cmake"
    DEPENDS "${file}" "${PROJECT_SOURCE_DIR}/cmake/EmbedText.cmake"
    COMMENT "Embedding ${file}" VERBATIM)
  target_sources(${target} PRIVATE "${source}")
  set_source_files_properties("${source}" PROPERTIES COMPILE_OPTIONS "-Wno-overlength-strings")
endfunction()
