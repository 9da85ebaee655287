# The compiler's contract, in one place. Every target links kelpie_flags.
add_library(kelpie_flags INTERFACE)
target_compile_features(kelpie_flags INTERFACE cxx_std_20)
target_include_directories(kelpie_flags INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_definitions(kelpie_flags INTERFACE
  KELPIE_VERSION="${PROJECT_VERSION}" GLM_FORCE_CTOR_INIT GLM_FORCE_SIZE_T_LENGTH GLM_FORCE_XYZW_ONLY)
target_compile_options(kelpie_flags INTERFACE
  # Values are IEEE values on every machine: no contraction, no reassociation. The two relaxations
  # below change no value; they let max() and sqrt() become single instructions.
  -ffp-contract=off -fno-math-errno -fno-trapping-math
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wimplicit-fallthrough
  $<$<BOOL:${KELPIE_WERROR}>:-Werror>)

# kelpie_folder(NAME [USES target...] [SOURCES file...]): the one target of a folder.
# Without sources (headers only) it is an interface library.
function(kelpie_folder name)
  cmake_parse_arguments(arg "" "" "USES;SOURCES" ${ARGN})
  if(arg_SOURCES)
    add_library(${name} STATIC ${arg_SOURCES})
    target_link_libraries(${name} PUBLIC kelpie_flags ${arg_USES})
  else()
    add_library(${name} INTERFACE)
    target_link_libraries(${name} INTERFACE kelpie_flags ${arg_USES})
  endif()
endfunction()
