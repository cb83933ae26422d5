# Cortex-M4F: floating-point unit for float; double is computed by the compiler's library.
set(cpu cortex-m4)
set(fpu fpv4-sp-d16)
set(board mps2-an386)
include(${CMAKE_CURRENT_LIST_DIR}/cortex-m.cmake)
