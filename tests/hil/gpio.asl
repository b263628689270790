// Two GPIO controllers that exist only as tables: their registers are plain RAM, which the kernel's
// command line keeps free (memmap) and which guest/gpio_poke.c changes from the other side. In the
// middle of the RAM, since QEMU puts the initramfs at its end, which would leave its bytes in them.
DefinitionBlock ("", "SSDT", 2, "TACTUS", "HILGPIO", 1)
{
    External (\_SB, DeviceObj)

    // Becomes gpiochip0: driver pinctrl-amd. Its interrupt is that of the second serial port, so
    // that gpio_poke can raise it; edge events work.
    Device (\_SB.GPIE)
    {
        Name (_HID, "AMDI0030")
        Name (_UID, Zero)
        Name (_CRS, ResourceTemplate ()
        {
            Memory32Fixed (ReadWrite, 0x20000000, 0x400)
            Interrupt (ResourceConsumer, Edge, ActiveHigh, Shared) { 3 }
        })
    }

    // Becomes gpiochip1: driver gpio-amdpt, without interrupt. Such a chip can only be polled.
    Device (\_SB.GPIP)
    {
        Name (_HID, "AMDIF031")
        Name (_UID, One)
        Name (_CRS, ResourceTemplate ()
        {
            Memory32Fixed (ReadWrite, 0x20001000, 0x100)
        })
    }
}
