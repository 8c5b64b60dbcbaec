#include "firmware/bare_metal/frame_in_flash.hpp"

asm(".section .rodata.frame_in_flash, \"a\"\n"
    ".balign 64\n"
    ".global frame_in_flash\n"
    "frame_in_flash:\n"
    ".incbin \"" COMPUEYE_FROZEN_FRAME
    "\"\n"
    ".global frame_in_flash_end\n"
    "frame_in_flash_end:\n"
    ".previous\n");
