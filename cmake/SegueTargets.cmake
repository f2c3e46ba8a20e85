# Targets of the project: one function per kind, so that every folder states only what is its own.
include_guard()

set(CMAKE_LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
# What is linked with a library of ours need not be linked again when only the library's code changes.
set(CMAKE_LINK_DEPENDS_NO_SHARED ON)

# Aggregates: what users run; what `make bench` measures; the fuzzers; and tests by the stage of tools/test that runs them, see
# segue_test.
add_custom_target(product)
add_custom_target(benchmarks)
add_custom_target(fuzzers)
add_custom_target(unit_tests)
add_custom_target(product_tests)
add_custom_target(nightly_tests)
add_custom_target(concurrency_tests)
add_custom_target(concurrency_at_night_tests)

# Clones in different folders share what ccache keeps: paths below the clone count as relative. (Debugging information then
# names the folder in which an object was compiled first.)
find_program(SEGUE_CCACHE ccache)
if(SEGUE_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1
                                  CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime ${SEGUE_CCACHE})
endif()

# What every target of ours is compiled with.
add_library(segue_flags INTERFACE)
target_compile_features(segue_flags INTERFACE cxx_std_20)
target_compile_options(segue_flags INTERFACE -Wall -Wextra -Wpedantic -Wconversion -Wshadow)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # False alarms in std::string's operator+ when it is inlined (gcc bug 105651).
  target_compile_options(segue_flags INTERFACE -Wno-restrict)
endif()
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # A class whose implementation is private to one source is no danger here, though gcc takes that source for a header.
  target_compile_options(segue_flags INTERFACE -Wno-subobject-linkage)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  # What a mutex protects is touched only while it is held (segue/base/mutex.hpp).
  target_compile_options(segue_flags INTERFACE -Wthread-safety)
endif()
if(SEGUE_WERROR)
  target_compile_options(segue_flags INTERFACE -Werror)
endif()
if(SEGUE_SANITIZE)
  # A finding ends the program, so that a test that has one fails.
  target_compile_options(segue_flags INTERFACE -fsanitize=${SEGUE_SANITIZE} -fno-sanitize-recover=all
                                               -fno-omit-frame-pointer)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # With the sanitizers' code in between, gcc sees unset variables where there are none.
    target_compile_options(segue_flags INTERFACE -Wno-maybe-uninitialized)
  endif()
  target_link_options(segue_flags INTERFACE -fsanitize=${SEGUE_SANITIZE})
  # For the few tests that count less, or replace what a sanitizer replaces: SEGUE_SANITIZER_ADDRESS, SEGUE_SANITIZER_THREAD.
  string(REGEX MATCH "address|thread" sanitizer "${SEGUE_SANITIZE}")
  string(TOUPPER "${sanitizer}" sanitizer)
  target_compile_definitions(segue_flags INTERFACE SEGUE_SANITIZER_${sanitizer})
endif()
# An executable that clang has built with sanitizers brings their runtime, which shared libraries leave open.
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  find_program(SEGUE_LLD NAMES ld.lld ld.lld-14)
  if(SEGUE_LLD)
    target_link_options(segue_flags INTERFACE -fuse-ld=lld)
  endif()
endif()

# segue_numeric(TARGET...): these compute much, which takes minutes without optimisation; they have it in sanitizer builds, too.
function(segue_numeric)
  foreach(target IN LISTS ARGV)
    if(SEGUE_SANITIZE AND TARGET ${target})
      target_compile_options(${target} PRIVATE -O1)
      set_target_properties(${target} PROPERTIES DISABLE_PRECOMPILE_HEADERS ON)  # these are compiled without
    endif()
  endforeach()
endfunction()

# segue_waits(TARGET...): these wait for people, files, networks or processes most of the time. In the release build they compile
# in two thirds of the time with -O1, by which gcc 12 takes some set values for unset ones.
function(segue_waits)
  foreach(target IN LISTS ARGV)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-Wno-maybe-uninitialized>)
    endif()
  endforeach()
endfunction()

# What uses Cap'n Proto links this: the library, and the C++ of our schemas.
set(SEGUE_SCHEMA_DIR ${CMAKE_BINARY_DIR}/schema)
add_library(segue_capnp INTERFACE)
target_link_libraries(segue_capnp INTERFACE CapnProto::capnp-rpc)
target_include_directories(segue_capnp SYSTEM INTERFACE ${SEGUE_SCHEMA_DIR})
# gcc 12 takes kj's holders of unset values for reads of them where they are inlined.
target_compile_options(segue_capnp INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
# All of that C++, for tools that compile nothing else.
add_custom_target(segue_schemas)

# segue_schema(FOLDER files...)
# Has the C++ of a folder's schemas made at build time, as <segue/FOLDER/FILE.h>, and sets SEGUE_SCHEMA_SOURCES. It is not ours,
# so it is compiled without our warnings. A schema of another folder is imported as "/segue/FOLDER/FILE".
function(segue_schema FOLDER)
  set(CAPNPC_OUTPUT_DIR ${SEGUE_SCHEMA_DIR}/segue/${FOLDER})
  set(CAPNPC_IMPORT_DIRS ${CMAKE_SOURCE_DIR})
  file(MAKE_DIRECTORY ${CAPNPC_OUTPUT_DIR})
  capnp_generate_cpp(sources headers ${ARGN})
  set_source_files_properties(${sources} PROPERTIES COMPILE_OPTIONS -w)
  add_custom_target(segue_schema_${FOLDER} DEPENDS ${sources} ${headers})
  add_dependencies(segue_schemas segue_schema_${FOLDER})
  set(SEGUE_SCHEMA_SOURCES ${sources} PARENT_SCOPE)
endfunction()

# segue_folder(NAME SOURCES ... [SEPARATE ...] [HEADERS ...] DEPENDS folders... [PUBLIC targets...] [PRIVATE targets...])
# The shared library of one folder of the house. Its include path holds only its own folder, through a tree of links
# made at configure time; what it may include beyond that comes from the folders it DEPENDS on. HEADERS are what users may
# include, and what these include; no other header is installed (tools/check_house). SEPARATE sources: see segue_test.
function(segue_folder NAME)
  cmake_parse_arguments(ARG "" "" "SOURCES;SEPARATE;HEADERS;DEPENDS;PUBLIC;PRIVATE" ${ARGN})
  # One tree for all presets: the same include path everywhere keeps compiler caches useful.
  set(view ${CMAKE_SOURCE_DIR}/build/include/${NAME})
  file(MAKE_DIRECTORY ${view}/segue)
  file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${view}/segue/${NAME} SYMBOLIC)

  add_library(segue_${NAME} SHARED ${ARG_SOURCES} ${ARG_SEPARATE})
  set_source_files_properties(${ARG_SEPARATE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  add_library(segue::${NAME} ALIAS segue_${NAME})
  target_include_directories(segue_${NAME} PUBLIC $<BUILD_INTERFACE:${view}> $<INSTALL_INTERFACE:include>)
  list(TRANSFORM ARG_DEPENDS PREPEND segue::)
  target_link_libraries(segue_${NAME} PUBLIC ${ARG_DEPENDS} ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:segue_flags>)
  target_compile_features(segue_${NAME} PUBLIC cxx_std_20)
  # Nobody replaces a function of a folder by one of another library, so calls within a folder are direct.
  target_compile_options(segue_${NAME} PRIVATE -fno-semantic-interposition)
  if(NOT SEGUE_SANITIZE)
    target_link_options(segue_${NAME} PRIVATE -Wl,--no-undefined)
  endif()
  set_target_properties(segue_${NAME} PROPERTIES EXPORT_NAME ${NAME} VERSION ${PROJECT_VERSION}
                        SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR} INSTALL_RPATH "$ORIGIN")
  add_dependencies(product segue_${NAME})
  install(TARGETS segue_${NAME} EXPORT segue LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} NAMELINK_COMPONENT dev)
  install(FILES ${ARG_HEADERS} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/segue/${NAME} COMPONENT dev)
endfunction()

# segue_embed(TARGET folders...)
# Makes the code of these folders a part of the program, in place of their shared libraries. A program that is started
# often begins several times as quickly then: most of what the dynamic loader does for it is looking up the symbols by
# which libraries call each other. The symbols are exported, so that a library that is loaded later, and needs one of
# these folders itself, uses the program's. Folders that component libraries link (task and what it needs) stay shared.
function(segue_embed TARGET)
  foreach(folder IN LISTS ARGN)
    target_sources(${TARGET} PRIVATE $<TARGET_OBJECTS:segue_${folder}>)
    target_include_directories(${TARGET} PRIVATE $<TARGET_PROPERTY:segue_${folder},INTERFACE_INCLUDE_DIRECTORIES>)
  endforeach()
  set_target_properties(${TARGET} PROPERTIES ENABLE_EXPORTS ON)
  if("rpc" IN_LIST ARGN)
    set(archives)
    foreach(name capnp-rpc capnp kj-async kj)
      find_library(SEGUE_ARCHIVE_${name} lib${name}.a)
      list(APPEND archives ${SEGUE_ARCHIVE_${name}})
    endforeach()
    if("${archives}" MATCHES "NOTFOUND")
      set(archives CapnProto::capnp-rpc)
    endif()
    target_link_libraries(${TARGET} PRIVATE ${archives})
  endif()
endfunction()

# segue_paths(TARGET NAME path ...)
# Gives a test program paths as constants (tests/support/paths.hpp) from a source of their own. As definitions they would
# be part of the command that compiles everything else, so that nothing compiled for one clone would serve in another.
function(segue_paths TARGET)
  set(file ${CMAKE_CURRENT_BINARY_DIR}/${TARGET}_${ARGV1}.cpp)
  set(text "namespace segue::paths {\n")
  while(ARGN)
    list(POP_FRONT ARGN name path)
    string(APPEND text "extern const char* const ${name};\nconst char* const ${name} = \"${path}\";\n")
  endwhile()
  file(GENERATE OUTPUT ${file} CONTENT "${text}}\n")
  target_sources(${TARGET} PRIVATE ${file})
  set_source_files_properties(${file} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON)
endfunction()

# What test programs include and few of them change, compiled once: GoogleTest, rapidcheck and the standard library. Compiling
# these takes longer than most tests. Clang notes times in it unless told not to, which would make compiler caches useless.
function(segue_test_headers)
  find_package(GTest REQUIRED)
  find_package(rapidcheck REQUIRED)
  add_library(segue_test_headers OBJECT ${CMAKE_SOURCE_DIR}/tests/support/headers.cpp)
  target_link_libraries(segue_test_headers PRIVATE segue_flags GTest::gmock_main rapidcheck rapidcheck_gtest)
  target_compile_options(segue_test_headers PRIVATE ${SEGUE_TEST_OPTIONS})
  target_precompile_headers(segue_test_headers PRIVATE ${CMAKE_SOURCE_DIR}/tests/support/headers.hpp)
endfunction()
# In the release build they compile in two thirds of the time with -O1.
set(SEGUE_TEST_OPTIONS $<$<CONFIG:Release>:-O1>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  list(APPEND SEGUE_TEST_OPTIONS "SHELL:-Xclang -fno-pch-timestamp")
endif()
if(BUILD_TESTING)
  segue_test_headers()
endif()

# What a GoogleTest program prints with --gtest_brief=1 where cases were skipped and none has failed. Output of a failed case has
# a bracket before that of the summary, so that a failure never counts as skipped.
set(SEGUE_SOME_SKIPPED "^[^[]*\\[==========\\][^[]*\\[  PASSED  \\][^[]*\\[  SKIPPED \\]")

# Test programs for another architecture run in an emulator, which is slow, and cannot run all of their cases.
set(SEGUE_TEST_PATIENCE 1)
set(SEGUE_CASES_LEFT_OUT)
if(CMAKE_CROSSCOMPILING)
  set(SEGUE_TEST_PATIENCE 10)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/tests/packaging/not_in_qemu)
  file(STRINGS ${CMAKE_SOURCE_DIR}/tests/packaging/not_in_qemu SEGUE_CASES_LEFT_OUT REGEX "^[^#]")
  list(JOIN SEGUE_CASES_LEFT_OUT ":" SEGUE_CASES_LEFT_OUT)
endif()

# What it prints where there are none, or all are left out.
set(SEGUE_NO_CASES " 0 tests from 0 test suites ran")

# segue_test(NAME SOURCES ... [SEPARATE ...] LINK targets... [KINDS unit|product|nightly...] [LABELS ...] [TIMEOUT seconds]
#            [SHARDS number] [SHARED_DATA] [WHERE_POSSIBLE])
# A GoogleTest (and rapidcheck) program, which may include <support/...>. It is one ctest entry, or with SHARDS so many, NAME_1 and
# so on, each of which runs a part of its cases. Its kinds are labels, and decide which stages of tools/test build and run it:
#   unit      (the default) under the sanitizers of addresses and undefined behaviour
#   product   in the release build: the programs as users run them, real time, and what tries too many cases for sanitizers
#   nightly   in the release build of a night only
# Labels `concurrency` and `concurrency_at_night`: also under thread sanitizer; `long`: it takes more than daily work should wait
# for (ctest -LE long leaves it out). SEPARATE sources are compiled on their own in unity
# builds too, because they define names that another source defines as well. SHARED_DATA: cases of suites whose names end in
# SharedData need data that is not part of Segue (tests/support/shared_data.hpp); they are a ctest entry of their own,
# NAME_shared_data, which is shown as skipped when they are. WHERE_POSSIBLE: likewise suites that end in WherePossible need what
# not every machine and user has.
function(segue_test NAME)
  if(NOT BUILD_TESTING)
    return()
  endif()
  cmake_parse_arguments(ARG "SHARED_DATA;WHERE_POSSIBLE" "TIMEOUT;SHARDS" "SOURCES;SEPARATE;LINK;KINDS;LABELS" ${ARGN})
  if(NOT ARG_KINDS)
    set(ARG_KINDS unit)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 400)
  endif()
  math(EXPR ARG_TIMEOUT "${SEGUE_TEST_PATIENCE} * ${ARG_TIMEOUT}")
  add_executable(${NAME} ${ARG_SOURCES} ${ARG_SEPARATE})
  set_source_files_properties(${ARG_SEPARATE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  target_link_libraries(${NAME} PRIVATE ${ARG_LINK} segue_flags GTest::gmock_main rapidcheck rapidcheck_gtest)
  target_include_directories(${NAME} PRIVATE ${CMAKE_SOURCE_DIR}/tests)
  target_compile_options(${NAME} PRIVATE ${SEGUE_TEST_OPTIONS})
  target_precompile_headers(${NAME} REUSE_FROM segue_test_headers)
  segue_paths(${NAME} kSourceFolder ${CMAKE_SOURCE_DIR})
  set_target_properties(${NAME} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
  foreach(kind IN LISTS ARG_KINDS)
    add_dependencies(${kind}_tests ${NAME})
  endforeach()
  foreach(label concurrency concurrency_at_night)
    if(label IN_LIST ARG_LABELS)
      add_dependencies(${label}_tests ${NAME})
    endif()
  endforeach()
  set(entries)
  set(apart ${SEGUE_CASES_LEFT_OUT})
  if(ARG_SHARED_DATA)
    segue_skippable_test(${NAME} shared_data SharedData)
  endif()
  if(ARG_WHERE_POSSIBLE)
    segue_skippable_test(${NAME} where_possible WherePossible)
  endif()
  if(apart)
    list(JOIN apart ":" apart)
    set(apart --gtest_filter=-${apart})
  endif()
  if(ARG_SHARDS)
    foreach(shard RANGE 1 ${ARG_SHARDS})
      math(EXPR index "${shard} - 1")
      add_test(NAME ${NAME}_${shard} COMMAND ${NAME} --gtest_brief=1 ${apart})
      set_tests_properties(${NAME}_${shard} PROPERTIES ENVIRONMENT "GTEST_TOTAL_SHARDS=${ARG_SHARDS};GTEST_SHARD_INDEX=${index}")
      list(APPEND entries ${NAME}_${shard})
    endforeach()
  else()
    add_test(NAME ${NAME} COMMAND ${NAME} --gtest_brief=1 ${apart})
    list(APPEND entries ${NAME})
  endif()
  # What may take long begins first (COST), so that nobody waits for it alone at the end.
  set(cost ${ARG_TIMEOUT})
  if("long" IN_LIST ARG_LABELS)
    set(cost 2000)
  endif()
  set_tests_properties(${entries} PROPERTIES TIMEOUT ${ARG_TIMEOUT} COST ${cost} LABELS "${ARG_KINDS};${ARG_LABELS}")
  if(SEGUE_CASES_LEFT_OUT)
    set_property(TEST ${entries} APPEND PROPERTY SKIP_REGULAR_EXPRESSION "${SEGUE_NO_CASES}")
  endif()
endfunction()

# Of segue_test: makes the entry NAME_KIND for the suites that end in SUITE, and leaves these out of the entry NAME. That there
# are none is a failure.
macro(segue_skippable_test NAME KIND SUITE)
  add_test(NAME ${NAME}_${KIND} COMMAND ${NAME} --gtest_brief=1 --gtest_filter=*${SUITE}.*-${SEGUE_CASES_LEFT_OUT})
  set_tests_properties(${NAME}_${KIND} PROPERTIES SKIP_REGULAR_EXPRESSION "${SEGUE_SOME_SKIPPED}")
  if(NOT SEGUE_CASES_LEFT_OUT)
    set_tests_properties(${NAME}_${KIND} PROPERTIES FAIL_REGULAR_EXPRESSION "${SEGUE_NO_CASES}")
  endif()
  list(APPEND entries ${NAME}_${KIND})
  list(APPEND apart *${SUITE}.*)
endmacro()

# segue_left_out(NAME WHY)
# In place of a part that cannot be built here: says why, now and as a ctest entry that is shown as skipped.
function(segue_left_out NAME WHY)
  message(STATUS "${WHY}")
  if(BUILD_TESTING)
    add_test(NAME ${NAME} COMMAND ${CMAKE_COMMAND} -E echo "skipped: ${WHY}")
    set_tests_properties(${NAME} PROPERTIES LABELS "unit;product" SKIP_REGULAR_EXPRESSION "^skipped: ")
  endif()
endfunction()

# segue_fuzzer(KIND_fuzz SOURCES ... LINK targets...)
# What tries inputs that others may have written. tests/fuzz/seeds/KIND holds texts from which the build makes a first corpus
# (tests/fuzz/make_corpus). With every compiler it is a test, KIND_fuzz_replay, that tries this corpus and simple changes of it.
# With SEGUE_FUZZ (clang) it is a libFuzzer program as well; as a ctest entry that searches for SEGUE_FUZZ_SECONDS, beginning with
# the corpus.
set(SEGUE_FUZZ_SECONDS 60 CACHE STRING "How long each fuzzer searches as a test")
function(segue_fuzzer NAME)
  if(NOT SEGUE_FUZZ AND NOT BUILD_TESTING)
    return()
  endif()
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  string(REGEX REPLACE "_fuzz$" "" kind ${NAME})
  set(fuzz ${CMAKE_SOURCE_DIR}/tests/fuzz)
  set(corpus ${CMAKE_BINARY_DIR}/fuzz/corpus/${kind})
  file(GLOB seeds CONFIGURE_DEPENDS ${fuzz}/seeds/${kind}/*.txt)
  add_custom_command(
    OUTPUT ${corpus}.stamp
    COMMAND ${fuzz}/make_corpus --stamp ${corpus}.stamp ${fuzz}/seeds/${kind} ${corpus}
    DEPENDS ${fuzz}/make_corpus ${seeds}
    DEPFILE ${corpus}.stamp.d
    COMMENT "Making the corpus of ${NAME}")
  add_custom_target(${NAME}_corpus DEPENDS ${corpus}.stamp)

  set(programs)
  if(BUILD_TESTING)
    if(NOT TARGET segue_replay)
      add_library(segue_replay OBJECT ${fuzz}/replay.cpp)
      target_link_libraries(segue_replay PRIVATE segue_flags)
    endif()
    list(APPEND programs ${NAME}_replay)
    add_executable(${NAME}_replay ${ARG_SOURCES})
    target_link_libraries(${NAME}_replay PRIVATE segue_replay)
    target_compile_options(${NAME}_replay PRIVATE $<$<CONFIG:Release>:-O1>)
    set_target_properties(${NAME}_replay PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests)
    add_dependencies(unit_tests ${NAME}_replay)
    add_test(NAME ${NAME}_replay COMMAND ${NAME}_replay ${corpus})
    set_tests_properties(${NAME}_replay PROPERTIES LABELS unit TIMEOUT 120)
  endif()
  if(SEGUE_FUZZ)
    list(APPEND programs ${NAME})
    add_executable(${NAME} ${ARG_SOURCES})
    target_compile_options(${NAME} PRIVATE -fsanitize=fuzzer)
    target_link_options(${NAME} PRIVATE -fsanitize=fuzzer)
    set_target_properties(${NAME} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/fuzz)
    add_dependencies(fuzzers ${NAME})
    file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/fuzz/${NAME}.found)
    add_test(NAME ${NAME}
             COMMAND ${NAME} -max_total_time=${SEGUE_FUZZ_SECONDS} -timeout=10 -rss_limit_mb=2048 -print_final_stats=1 ${CMAKE_BINARY_DIR}/fuzz/${NAME}.found ${corpus})
    math(EXPR limit "${SEGUE_FUZZ_SECONDS} + 300")
    set_tests_properties(${NAME} PROPERTIES LABELS fuzz TIMEOUT ${limit})
  endif()
  foreach(program IN LISTS programs)
    target_link_libraries(${program} PRIVATE ${ARG_LINK} segue_flags)
    add_dependencies(${program} ${NAME}_corpus)
  endforeach()
endfunction()
