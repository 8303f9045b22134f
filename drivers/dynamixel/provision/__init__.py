"""`bentod servo`: what a servo is given once, through the servo maker's own dynamixel-sdk."""
