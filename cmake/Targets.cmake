# SPDX-License-Identifier: Apache-2.0
# One way to declare a library of ours and one way to declare a test program.

set(POSESPACE_ROOT "${CMAKE_CURRENT_LIST_DIR}/..")

# What our own code is compiled with; third-party and generated code is not.
add_library(posespace_options INTERFACE)
# -Wrestrict: g++ 12 sees overlaps in std::string's own operator+ (GCC bug 105651).
target_compile_options(posespace_options INTERFACE -Wall -Wextra -Wshadow -Wnon-virtual-dtor
                       -Wno-restrict -ffp-contract=off)
if(POSESPACE_WERROR)
  target_compile_options(posespace_options INTERFACE -Werror)
endif()
if(POSESPACE_SANITIZE)
  add_compile_options(-fsanitize=${POSESPACE_SANITIZE} -fno-omit-frame-pointer
                      -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${POSESPACE_SANITIZE})
  # The checks that sanitizers insert make g++ see uninitialised variants where there are none.
  target_compile_options(posespace_options INTERFACE -Wno-maybe-uninitialized)
endif()

# posespace_library(NAME SOURCES ... DEPENDS ...): the library of one folder under server/.
function(posespace_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;PRIVATE_DEPENDS" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_include_directories(${name} PUBLIC "${POSESPACE_ROOT}/server")
  target_link_libraries(${name} PUBLIC ${ARG_DEPENDS} PRIVATE ${ARG_PRIVATE_DEPENDS}
                        posespace_options)
endfunction()

# posespace_test(NAME SOURCES ... DEPENDS ...): one GoogleTest program, run by ctest as a whole.
function(posespace_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE "${POSESPACE_ROOT}")
  target_link_libraries(${name} PRIVATE ${ARG_DEPENDS} posespace_options GTest::gmock
                        GTest::gtest_main)
  add_test(NAME ${name} COMMAND ${name} WORKING_DIRECTORY "${POSESPACE_ROOT}")
endfunction()
