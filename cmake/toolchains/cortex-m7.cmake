# The Cortex-M7 has a floating-point unit for double.
set(cpu cortex-m7)
set(fpu fpv5-d16)
set(board mps2-an500)
include(${CMAKE_CURRENT_LIST_DIR}/cortex-m.cmake)
