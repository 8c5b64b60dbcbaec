# Four single-precision lanes (MVE). QEMU's mps3-an547 is its board here.
set(core_flags "-mcpu=cortex-m55")
set(COMPUEYE_MEMORY_MAP mps3-an547.ld)
set(COMPUEYE_CLOCK_HZ 32000000) # of SysTick on that board
set(COMPUEYE_CORE_OPTIMISATION -O3 -fno-schedule-insns) # or g++ hoists loads until registers overflow to the stack
include(${CMAKE_CURRENT_LIST_DIR}/cortex-m.cmake)
