# The Cortex-M4F has a floating-point unit for float only. Arithmetic in double uses functions of the compiler.
set(cpu cortex-m4)
set(fpu fpv4-sp-d16)
set(board mps2-an386)
include(${CMAKE_CURRENT_LIST_DIR}/cortex-m.cmake)
