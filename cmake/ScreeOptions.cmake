# Options, output folders, and the one set of compiler flags that every target shares.

set(SCREE_CUDA AUTO CACHE STRING "CUDA backend: AUTO (when a compiler is found), ON or OFF")
set_property(CACHE SCREE_CUDA PROPERTY STRINGS AUTO ON OFF)
set(SCREE_MPI AUTO CACHE STRING "Runs on several processes by MPI: AUTO (when it is found), ON or OFF")
set_property(CACHE SCREE_MPI PROPERTY STRINGS AUTO ON OFF)
set(SCREE_NCCL AUTO CACHE STRING "Messages between GPUs by NCCL: AUTO (with CUDA and MPI, when it is found), ON or OFF")
set_property(CACHE SCREE_NCCL PROPERTY STRINGS AUTO ON OFF)
set(SCREE_CUDA_ARCHITECTURES AUTO CACHE STRING
  "CUDA architectures to build for, for instance 80;90; AUTO: those of the GPUs of this machine, 90 without one")
set(SCREE_EXTRA_SOLVERS "" CACHE STRING "Headers of further solvers of steps (a list), as CONTRIBUTING.md describes them")
set(SCREE_EXTRA_SHAPES "" CACHE STRING "Headers of further shapes (a list), as CONTRIBUTING.md describes them")
set(SCREE_EXTRA_PAIRS "" CACHE STRING "Headers of their pair functions (a list)")
set(SCREE_EXTRA_DYNAMICS "" CACHE STRING "Headers of further models of dynamics (a list), as CONTRIBUTING.md describes them")
set(SCREE_SANITIZE "" CACHE STRING "Host sanitizers, for instance address;undefined")
set(SCREE_TEST_LAUNCHER "" CACHE STRING "Command (a list) put before the CUDA test program")
set(SCREE_BATCH 8 CACHE STRING
  "Sources compiled together, of tests and of what runs once, which halves the time for all of them; with 1 a changed one is compiled sooner")
option(SCREE_CUDA_TESTS_AS_PTX "Compile CUDA tests as far as PTX, in a quarter of the time, where they cannot run" OFF)
option(SCREE_NATIVE "Build for the processor of this machine" ON)
option(SCREE_WERROR "Treat warnings as errors" OFF)
option(SCREE_CHECK_SYNC "Synchronize after each kernel launch, so that a fault names its kernel" OFF)
option(SCREE_REQUIRE_GPU "A skipped CUDA test fails" OFF)
option(SCREE_CHARTS "Draw charts, where Cairo is found" ON)
option(SCREE_BUILD_TESTS "Build the tests" ${PROJECT_IS_TOP_LEVEL})
option(SCREE_FUZZ "Build libFuzzer targets of the readers, which needs clang and the preset fuzz" OFF)
option(SCREE_BUILD_BENCH "Build the benchmarks" ${PROJECT_IS_TOP_LEVEL})

if(PROJECT_IS_TOP_LEVEL)
  if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
  endif()
  set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")
  set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
endif()
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

# Floating point is the same everywhere: IEEE arithmetic (no -ffast-math). On the host multiply-adds are
# not contracted: which ones are depends on inlining and on the tail of a vectorized loop, so results would
# depend on the number of threads. A CUDA kernel is compiled once, so there contraction is harmless.
set(host_flags -Wall -Wextra -ffp-contract=off -fno-math-errno)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # False alarms in std::string (GCC bug 105651) and in GCC's own AVX-512 headers (105593).
  list(APPEND host_flags -Wno-restrict -Wno-maybe-uninitialized -Wno-uninitialized)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # Units of many templates take 2 GB. Where there is as much for each job, GCC need not look for what it could free: a seventh of
  # its time.
  cmake_host_system_information(RESULT memory QUERY TOTAL_PHYSICAL_MEMORY)
  cmake_host_system_information(RESULT processors QUERY NUMBER_OF_LOGICAL_CORES)
  math(EXPR memory_of_job "${memory} / ${processors}") # [MiB]
  if(memory_of_job GREATER 3000)
    list(APPEND host_flags --param=ggc-min-heapsize=1048576)
  endif()
endif()
if(SCREE_NATIVE)
  list(APPEND host_flags -march=native)
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang" AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    # Clang picks the wrong lanes where std::experimental::simd of libstdc++ 12 selects by AVX-512.
    list(APPEND host_flags -mno-avx512f)
  endif()
endif()
if(SCREE_WERROR)
  list(APPEND host_flags -Werror)
endif()
if(SCREE_SANITIZE)
  list(TRANSFORM SCREE_SANITIZE PREPEND "-fsanitize=" OUTPUT_VARIABLE sanitizer_flags)
  list(APPEND host_flags ${sanitizer_flags} -fno-omit-frame-pointer -fno-sanitize-recover=all)
endif()
list(TRANSFORM host_flags PREPEND "-Xcompiler=" OUTPUT_VARIABLE xcompiler_flags)
set(cuda_flags ${xcompiler_flags} -Xcompiler=-fopenmp -fmad=true --expt-relaxed-constexpr -lineinfo)
if(SCREE_WERROR)
  list(APPEND cuda_flags --Werror=all-warnings)
endif()

add_library(scree_options INTERFACE)
target_compile_options(scree_options INTERFACE
  "$<$<COMPILE_LANGUAGE:C,CXX>:${host_flags}>" "$<$<COMPILE_LANGUAGE:CUDA>:${cuda_flags}>")
target_link_options(scree_options INTERFACE ${sanitizer_flags})
# The caller decides what runs in parallel, and Eigen takes units of nvcc for what they are to the host, with its vectors. For all units or
# none: those that disagree share Eigen's functions, and products of matrices then go wrong now and then.
target_compile_definitions(scree_options INTERFACE EIGEN_DONT_PARALLELIZE EIGEN_NO_CUDA)
