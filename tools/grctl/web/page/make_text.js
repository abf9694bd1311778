// SPDX-License-Identifier: MIT
// The texts of the view "Make" in Japanese.

export const JA_MAKE = {
    Make: '編集', 'Undo (Ctrl+Z)': '元に戻す (Ctrl+Z)', 'Redo (Ctrl+Y)': 'やり直す (Ctrl+Y)', '+ Key': '+ キー',
    Copy: 'コピー', Paste: '貼り付け', Delete: '削除', 'Key poses': 'キーポーズ',
    'Position in the draft': '下書きの位置', 'Motion to edit': '編集するモーション', New: '新規', Save: '保存',
    'Name of a new file': '新しいファイルの名前', 'Save as': '別名で保存', 'At, s': '時刻 (秒)',
    'Way to it, s': '移行時間 (秒)', Name: '名前', 'Feet and waist': '足と腰', Handle: 'ハンドル',
    'From and to the robot': 'ロボットとのやりとり', 'Joints to make limp': '脱力させる関節',
    'Capture here': 'ここに取り込む', 'Capture as new key': '新しいキーとして取り込む',
    'Show on robot': 'ロボットで確認', 'Show on robot, {0} s': 'ロボットで確認 ({0} 秒)',
    'Joints of this pose': 'このポーズの関節', 'Both sides': '左右両方', 'Compare, mirror all': '比較、全体の左右反転',
    'Motion to compare with': '比較するモーション', 'Largest differences': '差の大きい関節', Largest: '最大差',
    Mean: '平均', 'Mirror the whole motion': '全体を左右反転',
    'Open a motion or begin a new one. What is drawn here moves nothing: the robot follows only by Show on robot, or when the saved motion is played.':
        'モーションを開くか、新しく始めてください。ここでの編集ではロボットは動きません。「ロボットで確認」を押したとき、または保存したモーションを再生したときだけ動きます。',
    'Make: undo, redo, copy and paste a key pose': '編集: 元に戻す、やり直す、キーポーズのコピーと貼り付け',
    'on a key pose: the next one; with Shift: earlier, later; delete it':
        'キーポーズ上: 前後へ移動。Shift 併用: 時刻をずらす。Del: 削除',
    'Key pose {0} of {1}, {2} s': 'キーポーズ {0}/{1}、{2} 秒', 'Key pose {0} of {1}': 'キーポーズ {0}/{1}',
    'Between key poses: an edit adds one here': 'キーポーズの間: 編集するとここに追加されます',
    Waist: '腰', 'Right foot': '右足', 'Left foot': '左足', Up: '上', Down: '下', Forward: '前', Back: '後',
    'To its left': '左', 'To its right': '右', 'Open a motion …': 'モーションを開く…', 'with …': '比較相手…',
    'What was changed is not saved. Leave it?': '変更は保存されていません。破棄しますか?',
    '{0} has too many key poses to be edited here.': '{0} はキーポーズが多すぎて、ここでは編集できません。',
    'Taken from the frames of {0}, a key pose every {1} s. Save it under another name.':
        '{0} のフレームから {1} 秒ごとにキーポーズを作りました。別名で保存してください。',
    '{0} is seen every {1} s. Save moves its frames around what you change; under another name they become key poses.':
        '{0} を {1} 秒ごとに表示しています。保存すると、変更した箇所の前後のフレームが動きます。別名ではキーポーズになります。',
    '▲ out of balance from {0} s': '▲ {0} 秒からバランスを失います',
    Undone: '元に戻しました', 'Done again': 'やり直しました', Copied: 'コピーしました', 'out of reach': '届かない',
    '{0} is not set by this key pose': 'このキーポーズでは {0} を指定しない',
    '(not set by this key pose)': '(このキーポーズでは指定なし)',
    'Give the new file a name.': '新しいファイルの名前を入力してください。', 'Saved as {0}.': '{0} に保存しました。',
    'A copy was written as {0}.': 'コピーを {0} に書き出しました。',
    '{0} has changed since it was opened. Save under another name, or open it again.':
        '{0} は開いた後に変更されています。別名で保存するか、開き直してください。',
    '{0} is there already, or what it is made of has changed. Choose another name.':
        '{0} はすでにあるか、元のファイルが変更されています。別の名前にしてください。',
    '{0} joints were read from the robot.': 'ロボットから {0} 関節を読み取りました。',
    'In this pose the robot would fall. Move it there?': 'この姿勢ではロボットが倒れます。動かしますか?',
    '{0} s here, {1} s there.': 'こちら {0} 秒、相手 {1} 秒。', '{0} of {1} joints differ.': '{1} 関節中 {0} に差があります。',
    'All angles are the same.': '角度はすべて同じです。', 'draft: the robot does not move': '下書き (ロボットは動きません)',
    robot: 'ロボット', 'new motion': '新しいモーション', '▲ changed elsewhere': '▲ 他で変更あり',
    'not saved': '未保存', saved: '保存済み',
    all: '全身', body: '胴体', right_arm: '右腕', left_arm: '左腕', arms: '両腕', right_leg: '右脚',
    left_leg: '左脚', legs: '両脚',
};
